// Times Pinocchio's rigid-body algorithms. usage: bench TAG MS ROBOT=DIR ...  (reads DIR/ROBOT.model and .states)
// prints robot,function,ns_median,batches,tag
#include "model.hpp"
#include "../common.hpp"
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/center-of-mass.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/centroidal-derivatives.hpp>
#include <pinocchio/algorithm/cholesky.hpp>
#include <pinocchio/algorithm/compute-all-terms.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/energy.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/frames-derivatives.hpp>
#include <pinocchio/algorithm/impulse-dynamics.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/kinematics-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>

namespace pin = pinocchio;

static void run(const char* robot, const Robot& r, const std::vector<State>& states, const char* tag, double ms) {
  const auto& m = r.model;
  using V = Eigen::VectorXd;
  pin::DataTpl<double> d(m);
  const int n = (int)states.size();
  std::vector<V> q, v, a, tau;
  auto eigen = [](const std::vector<double>& x) { return V(Eigen::Map<const V>(x.data(), x.size())); };
  for (const auto& s : states) { q.push_back(eigen(s.q)); v.push_back(eigen(s.v)); a.push_back(eigen(s.a)); tau.push_back(eigen(s.tau)); }
  std::vector<pin::FrameIndex> feet;
  for (const auto& f : r.feet) feet.push_back(m.getFrameId(f.name));
  using M6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  M6 J(6, m.nv), v_dq(6, m.nv), a_dq(6, m.nv), a_dv(6, m.nv), a_da(6, m.nv);
  V out(m.nq), dout(m.nv);
  std::vector<pin::ForceTpl<double>> fext(m.njoints, pin::ForceTpl<double>::Zero());
  for (const auto& f : r.feet) fext[f.joint].linear() = Eigen::Vector3d(1, 2, 30);
  std::vector<pin::RigidConstraintModelTpl<double, 0>, Eigen::aligned_allocator<pin::RigidConstraintModelTpl<double, 0>>> cm;
  std::vector<pin::RigidConstraintDataTpl<double, 0>, Eigen::aligned_allocator<pin::RigidConstraintDataTpl<double, 0>>> cd;
  for (const auto& f : r.feet) cm.emplace_back(r.contact_rows == 3 ? pin::CONTACT_3D : pin::CONTACT_6D, m, f.joint, f.placement, pin::LOCAL);
  for (const auto& c : cm) cd.emplace_back(c);
  pin::DataTpl<double> dc(m);
  pin::initConstraintDynamics(m, dc, cm, cd);
  pin::ProximalSettingsTpl<double> settings(1e-12, 0.0, 1);
  auto T = [&](const char* fn, auto&& f) { time_it(robot, fn, tag, ms, n, f); };

  T("rnea", [&](int i) { sink(pin::rnea(m, d, q[i], v[i], a[i]).data()); });
  T("rnea_external", [&](int i) { sink(pin::rnea(m, d, q[i], v[i], a[i], fext).data()); });
  T("nonlinear_effects", [&](int i) { sink(pin::nonLinearEffects(m, d, q[i], v[i]).data()); });
  T("gravity", [&](int i) { sink(pin::computeGeneralizedGravity(m, d, q[i]).data()); });
  T("crba", [&](int i) { sink(pin::crba(m, d, q[i], pin::Convention::WORLD).data()); });
  T("crba_local", [&](int i) { sink(pin::crba(m, d, q[i], pin::Convention::LOCAL).data()); });
  T("aba", [&](int i) { sink(pin::aba(m, d, q[i], v[i], tau[i], pin::Convention::LOCAL).data()); });
  T("aba_world", [&](int i) { sink(pin::aba(m, d, q[i], v[i], tau[i], pin::Convention::WORLD).data()); });
  T("minverse", [&](int i) { sink(pin::computeMinverse(m, d, q[i]).data()); });
  T("rnea_crba_aba", [&](int i) {
    sink(pin::rnea(m, d, q[i], v[i], a[i]).data());
    sink(pin::crba(m, d, q[i], pin::Convention::LOCAL).data());
    sink(pin::aba(m, d, q[i], v[i], tau[i], pin::Convention::LOCAL).data());
  });
  T("fk_placements", [&](int i) { pin::forwardKinematics(m, d, q[i]); sink(&d.oMi.back()); });
  T("fk_velocities", [&](int i) { pin::forwardKinematics(m, d, q[i], v[i]); sink(&d.v.back()); });
  T("fk_accelerations", [&](int i) { pin::forwardKinematics(m, d, q[i], v[i], a[i]); sink(&d.a.back()); });
  T("feet_accelerations", [&](int i) {
    pin::forwardKinematics(m, d, q[i], v[i], a[i]);
    for (auto id : feet) { pin::updateFramePlacement(m, d, id); auto x = pin::getFrameClassicalAcceleration(m, d, id, pin::LOCAL_WORLD_ALIGNED); sink(&x); }
  });
  T("joint_jacobians", [&](int i) { sink(pin::computeJointJacobians(m, d, q[i]).data()); });
  T("feet_jacobians", [&](int i) {
    pin::computeJointJacobians(m, d, q[i]);
    for (auto id : feet) { pin::updateFramePlacement(m, d, id); J.setZero(); pin::getFrameJacobian(m, d, id, pin::LOCAL_WORLD_ALIGNED, J); sink(J.data()); }
  });
  T("jacobian_time_variation", [&](int i) { sink(pin::computeJointJacobiansTimeVariation(m, d, q[i], v[i]).data()); });
  T("com", [&](int i) { sink(pin::centerOfMass(m, d, q[i]).data()); });
  T("com_acceleration", [&](int i) { sink(pin::centerOfMass(m, d, q[i], v[i], a[i]).data()); });
  T("com_jacobian", [&](int i) { sink(pin::jacobianCenterOfMass(m, d, q[i]).data()); });
  T("centroidal_map", [&](int i) { sink(pin::computeCentroidalMap(m, d, q[i]).data()); });
  T("centroidal_map_rate", [&](int i) { sink(pin::dccrba(m, d, q[i], v[i]).data()); });
  T("centroidal_momentum", [&](int i) { sink(&pin::computeCentroidalMomentum(m, d, q[i], v[i])); });
  T("centroidal_momentum_rate", [&](int i) { sink(&pin::computeCentroidalMomentumTimeVariation(m, d, q[i], v[i], a[i])); });
  T("energies", [&](int i) { double k = pin::computeKineticEnergy(m, d, q[i], v[i]), p = pin::computePotentialEnergy(m, d, q[i]); sink(&k); sink(&p); });
  T("rnea_derivatives", [&](int i) { pin::computeRNEADerivatives(m, d, q[i], v[i], a[i]); sink(d.dtau_dq.data()); });
  T("aba_derivatives", [&](int i) { pin::computeABADerivatives(m, d, q[i], v[i], tau[i]); sink(d.ddq_dq.data()); });
  T("feet_acceleration_derivatives", [&](int i) {
    pin::computeForwardKinematicsDerivatives(m, d, q[i], v[i], a[i]);
    for (auto id : feet) { pin::getFrameAccelerationDerivatives(m, d, id, pin::LOCAL, v_dq, a_dq, a_dv, a_da); sink(a_dq.data()); }
  });
  M6 dh_dq(6, m.nv), dhd_dq(6, m.nv), dhd_dv(6, m.nv), dhd_da(6, m.nv);
  T("centroidal_derivatives", [&](int i) { pin::computeCentroidalDynamicsDerivatives(m, d, q[i], v[i], a[i], dh_dq, dhd_dq, dhd_dv, dhd_da); sink(dhd_dq.data()); });
  T("constrained_dynamics", [&](int i) { sink(pin::constraintDynamics(m, dc, q[i], v[i], tau[i], cm, cd, settings).data()); });
  T("impulse_dynamics", [&](int i) { sink(pin::impulseDynamics(m, dc, q[i], v[i], cm, cd, 0.0, settings).data()); });
  T("cholesky_after_crba", [&](int i) { pin::crba(m, d, q[i], pin::Convention::WORLD); sink(pin::cholesky::decompose(m, d).data()); });
  T("all_terms", [&](int i) { pin::computeAllTerms(m, d, q[i], v[i]); sink(d.M.data()); });
  T("integrate", [&](int i) { pin::integrate(m, q[i], v[i], out); sink(out.data()); });
  T("difference", [&](int i) { pin::difference(m, q[i], q[(i + 1) % n], dout); sink(dout.data()); });
}

int main(int argc, char** argv) {
  if (argc < 4) { std::fprintf(stderr, "usage: bench TAG MS ROBOT=DIR ...\n"); return 1; }
  for (int k = 3; k < argc; ++k) {
    const std::string s = argv[k], robot = s.substr(0, s.find('=')), dir = s.substr(s.find('=') + 1);
    run(robot.c_str(), read_model(dir + "/" + robot + ".model"), read_states(dir + "/" + robot + ".states"), argv[1], std::atof(argv[2]));
  }
}
