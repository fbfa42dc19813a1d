// One controller tick of TSID (dynamics, tasks, QP by eiquadprog-fast) on the states that wbc-qp's example `ticks` wrote.
// usage: bench ROBOT.model ROBOT.ticks
#include "../common.hpp"
#include "../pinocchio/model.hpp"

#include <tsid/contacts/contact-6d.hpp>
#include <tsid/contacts/contact-point.hpp>
#include <tsid/formulations/inverse-dynamics-formulation-acc-force.hpp>
#include <tsid/robots/robot-wrapper.hpp>
#include <tsid/solvers/solver-HQP-eiquadprog-fast.hpp>
#include <tsid/tasks/task-actuation-bounds.hpp>
#include <tsid/tasks/task-actuation-equality.hpp>
#include <tsid/tasks/task-angular-momentum-equality.hpp>
#include <tsid/tasks/task-com-equality.hpp>
#include <tsid/tasks/task-joint-posVelAcc-bounds.hpp>
#include <tsid/tasks/task-joint-posture.hpp>
#include <tsid/tasks/task-se3-equality.hpp>

#include <memory>

using namespace tsid;
using Eigen::VectorXd;

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  auto robot_file = read_model(argv[1]);
  const bool humanoid = robot_file.contact_rows == 6;
  robot_file.model.addFrame({"trunk", 1, 0, pinocchio::SE3::Identity(), pinocchio::OP_FRAME});
  robots::RobotWrapper robot(robot_file.model, robots::RobotWrapper::FLOATING_BASE_SYSTEM, false);
  const int nv = robot.nv(), na = nv - 6, nq = robot.nq();

  // Header: ticks, joints; limits (lower, upper, speed, effort) per joint, posture, dt; then q v com(9) per tick.
  std::ifstream f(argv[2]);
  int n = 0, joints = 0;
  if (!(f >> n >> joints) || joints != na) { std::fprintf(stderr, "%s does not fit %s\n", argv[2], argv[1]); return 2; }
  auto read = [&](int k) { VectorXd x(k); for (int i = 0; i < k; ++i) f >> x[i]; return x; };
  const VectorXd lower = read(na), upper = read(na), speed = read(na), effort = read(na), posture = read(na);
  struct Tick { VectorXd q, v, com; };
  std::vector<Tick> ticks(n);
  for (auto& t : ticks) { t.q = read(nq); t.v = read(nv); t.com = read(9); }

  InverseDynamicsFormulationAccForce form("tick", robot, false);
  form.computeProblemData(0.0, ticks[0].q, ticks[0].v);
  const Eigen::Vector3d up(0, 0, 1);
  std::vector<std::unique_ptr<contacts::ContactBase>> feet;
  for (const auto& foot : robot_file.feet) {
    if (humanoid) {
      const double y = foot.name[0] == 'l' ? -0.031 : -0.041;
      Eigen::Matrix<double, 3, 4> corners;
      corners << -0.0535, -0.0535, 0.1065, 0.1065, y, y + 0.072, y, y + 0.072, 0, 0, 0, 0;
      auto c = std::make_unique<contacts::Contact6d>(foot.name, robot, foot.name, corners, up, 0.5, 0.0, 1000.0);
      c->Kp(VectorXd::Zero(6));
      c->Kd(VectorXd::Constant(6, 20.0));
      c->setReference(robot.framePosition(form.data(), robot.model().getFrameId(foot.name)));
      form.addRigidContact(*c, 1e-3);
      feet.push_back(std::move(c));
    } else {
      auto c = std::make_unique<contacts::ContactPoint>(foot.name, robot, foot.name, up, 0.5, 0.0, 300.0);
      c->Kp(VectorXd::Zero(3));
      c->Kd(VectorXd::Constant(3, 20.0));
      c->setReference(robot.framePosition(form.data(), robot.model().getFrameId(foot.name)));
      form.addRigidContact(*c, 1e-3);
      feet.push_back(std::move(c));
    }
  }
  tasks::TaskComEquality com("com", robot);
  com.Kp(VectorXd::Constant(3, 100.0));
  com.Kd(VectorXd::Constant(3, 20.0));
  form.addMotionTask(com, humanoid ? 1e5 : 1e3, 1);
  tasks::TaskAMEquality momentum("momentum", robot);
  tasks::TaskSE3Equality trunk("trunk", robot, "trunk");
  if (humanoid) {
    momentum.Kp(VectorXd::Constant(3, 10.0));
    momentum.Kd(VectorXd::Zero(3));
    trajectories::TrajectorySample zero(3);
    momentum.setReference(zero);
    form.addMotionTask(momentum, 1e5, 1);
  } else {
    trunk.Kp(VectorXd::Constant(6, 100.0));
    trunk.Kd(VectorXd::Constant(6, 20.0));
    VectorXd mask(6);
    mask << 0, 0, 0, 1, 1, 1;
    trunk.setMask(mask);
    trunk.setReference(pinocchio::SE3::Identity());
    form.addMotionTask(trunk, 1e3, 1);
  }
  tasks::TaskJointPosture joint("posture", robot);
  joint.Kp(VectorXd::Constant(na, humanoid ? 50.0 : 0.0));
  joint.Kd(VectorXd::Constant(na, humanoid ? 14.0 : 0.0));
  trajectories::TrajectorySample at(na);
  at.setValue(posture);
  at.setDerivative(VectorXd::Zero(na));
  at.setSecondDerivative(VectorXd::Zero(na));
  joint.setReference(at);
  form.addMotionTask(joint, humanoid ? 1.0 : 1e-2, 1);
  tasks::TaskActuationEquality last("continuity", robot);
  if (humanoid) {
    last.setReference(VectorXd::Zero(na));
    form.addActuationTask(last, 1e-3, 1);
  }
  tasks::TaskActuationBounds torque("torque", robot);
  torque.setBounds(-effort, effort);
  form.addActuationTask(torque, 1.0, 0);
  tasks::TaskJointPosVelAccBounds bounds("joints", robot, 0.01, false);
  if (humanoid) {
    bounds.setPositionBounds(lower, upper);
    bounds.setVelocityBounds(speed);
    bounds.setAccelerationBounds(VectorXd::Constant(na, 1000.0));
    bounds.setImposeBounds(true, true, false, true);
    form.addMotionTask(bounds, 1.0, 0);
  }
  solvers::SolverHQuadProgFast solver("eiquadprog-fast");
  solver.resize(form.nVar(), form.nEq(), form.nIn());

  std::vector<double> all, alone;
  int solved = 0;
  for (const auto& t : ticks) {
    double best = 1e18, best_qp = 1e18;
    trajectories::TrajectorySample c(3);
    c.setValue(t.com.head(3));
    c.setDerivative(t.com.segment(3, 3));
    c.setSecondDerivative(t.com.tail(3));
    com.setReference(c);
    bool ok = false;
    VectorXd tau;
    for (int k = 0; k < 7; ++k) {
      const double start = now();
      const auto& data = form.computeProblemData(0.0, t.q, t.v);
      const double middle = now();
      const auto& out = solver.solve(data);
      const double end = now();
      ok = out.status == solvers::HQP_STATUS_OPTIMAL;
      if (ok) tau = form.getActuatorForces(out);
      best = std::min(best, now() - start);
      best_qp = std::min(best_qp, end - middle);
    }
    if (humanoid && ok) last.setReference(tau);
    solved += ok;
    all.push_back(best);
    alone.push_back(best_qp);
  }
  auto median = [](std::vector<double> x) { std::nth_element(x.begin(), x.begin() + x.size() / 2, x.end()); return x[x.size() / 2]; };
  std::printf("%.3f %.3f %.3f %d %d %d %d\n", median(all) / 1e3, *std::max_element(all.begin(), all.end()) / 1e3, median(alone) / 1e3,
              solved, form.nVar(), form.nEq(), form.nIn());
}
