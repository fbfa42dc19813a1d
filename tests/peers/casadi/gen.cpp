// Emits CasADi-generated C for Pinocchio's RNEA, CRBA, ABA and centroidal map: straight-line code of one robot.
// usage: gen FILE.model ROBOT   (writes ROBOT_gen.c)
#include <pinocchio/autodiff/casadi.hpp>
#include "../pinocchio/model.hpp"
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <iostream>

namespace pin = pinocchio;
using S = casadi::SX;

int main(int, char** argv) {
  const std::string robot = argv[2];
  const pin::ModelTpl<S> m = read_model(argv[1], true).model.cast<S>();
  pin::DataTpl<S> d(m);
  using V = Eigen::Matrix<S, Eigen::Dynamic, 1>;
  S q = S::sym("q", m.nq), v = S::sym("v", m.nv), a = S::sym("a", m.nv);
  V eq(m.nq), ev(m.nv), ea(m.nv);
  for (int i = 0; i < m.nq; ++i) eq[i] = q(i);
  for (int i = 0; i < m.nv; ++i) { ev[i] = v(i); ea[i] = a(i); }
  auto dense = [](const auto& x) {
    S r(x.rows(), x.cols());
    for (int i = 0; i < x.rows(); ++i) for (int j = 0; j < x.cols(); ++j) r(i, j) = x(i, j);
    return casadi::SX::densify(r);
  };
  casadi::Dict quiet, cse;
  quiet["with_header"] = false;
  cse["cse"] = true;
  casadi::CodeGenerator out(robot + "_gen.c", quiet);
  auto add = [&](const std::string& name, const std::vector<S>& in, const S& value) {
    casadi::Function g(robot + "_" + name, in, {value}, cse);
    std::cerr << robot << " " << name << ": " << g.n_instructions() << " instructions\n";
    out.add(g);
  };
  pin::rnea(m, d, eq, ev, ea);
  add("rnea", {q, v, a}, dense(V(d.tau)));
  pin::crba(m, d, eq, pin::Convention::LOCAL);
  Eigen::Matrix<S, -1, -1> M = d.M;
  for (int i = 0; i < m.nv; ++i) for (int j = 0; j < i; ++j) M(i, j) = M(j, i);
  add("crba", {q}, dense(M));
  pin::aba(m, d, eq, ev, ea, pin::Convention::LOCAL);
  add("aba", {q, v, a}, dense(V(d.ddq)));
  pin::computeCentroidalMap(m, d, eq);
  add("centroidal_map", {q}, dense(Eigen::Matrix<S, 6, -1>(d.Ag)));
  out.generate();
}
