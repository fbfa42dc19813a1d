// Reads the plain-text model that dump_models.py writes.
#pragma once
#if __has_include(<pinocchio/multibody.hpp>)
#include <pinocchio/multibody.hpp>
#else  // Pinocchio 3
#include <pinocchio/multibody/model.hpp>
#endif
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

struct Foot { std::string name; int joint; pinocchio::SE3Tpl<double> placement; };
struct Robot { pinocchio::ModelTpl<double> model; std::vector<Foot> feet; int contact_rows; };

// `clean` drops round-off near 0 and +-1 from axes and placements: exact zeros help a code generator.
inline Robot read_model(const std::string& path, bool clean = false) {
  namespace pin = pinocchio;
  std::ifstream f(path);
  int n = 0;
  if (!(f >> n)) { std::fprintf(stderr, "cannot read %s\n", path.c_str()); std::exit(2); }
  Robot r;
  auto& m = r.model;
  auto tidy = [clean](double v) {
    if (!clean) return v;
    return std::abs(v) < 1e-14 ? 0.0 : std::abs(std::abs(v) - 1) < 1e-14 ? (v > 0 ? 1.0 : -1.0) : v;
  };
  auto vec = [&] { Eigen::Vector3d x; for (int k = 0; k < 3; ++k) f >> x[k]; return x; };
  auto mat = [&] { Eigen::Matrix3d x; for (int k = 0; k < 9; ++k) f >> x(k / 3, k % 3); return x; };
  for (int i = 0; i < n; ++i) {
    std::string name, kind;
    int parent;
    double mass;
    f >> name >> parent >> kind;
    const Eigen::Vector3d axis = vec().unaryExpr(tidy);
    const Eigen::Matrix3d R = mat().unaryExpr(tidy);
    const Eigen::Vector3d p = vec();
    f >> mass;
    const Eigen::Vector3d c = vec();
    const Eigen::Matrix3d I = mat();
    const pin::SE3Tpl<double> M(R, p);
    pin::JointIndex j;
    if (kind == "FF") j = m.addJoint(parent, pin::JointModelFreeFlyerTpl<double>(), M, name);
    else if (kind == "RX") j = m.addJoint(parent, pin::JointModelRevoluteTpl<double, 0, 0>(), M, name);
    else if (kind == "RY") j = m.addJoint(parent, pin::JointModelRevoluteTpl<double, 0, 1>(), M, name);
    else if (kind == "RZ") j = m.addJoint(parent, pin::JointModelRevoluteTpl<double, 0, 2>(), M, name);
    else j = m.addJoint(parent, pin::JointModelRevoluteUnalignedTpl<double>(axis), M, name);
    m.appendBodyToJoint(j, pin::InertiaTpl<double>(mass, c, pin::Symmetric3Tpl<double>(I)));
  }
  int nf;
  f >> nf >> r.contact_rows;
  for (int i = 0; i < nf; ++i) {
    Foot foot;
    f >> foot.name >> foot.joint;
    const Eigen::Matrix3d R = mat();
    foot.placement = pin::SE3Tpl<double>(R, vec());
    m.addFrame(pin::FrameTpl<double>(foot.name, foot.joint, 0, foot.placement, pin::OP_FRAME));
    r.feet.push_back(foot);
  }
  return r;
}
