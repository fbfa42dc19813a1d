// Times the generated functions of one robot: compile with -DROBOT=a1 and link a1_gen.c.
// usage: bench TAG MS ROBOT=DIR   prints robot,function,ns_median,batches,tag
#include "../common.hpp"
#define CAT2(a, b) a##b
#define CAT(a, b) CAT2(a, b)
#define DECLARE(f) extern "C" int CAT(ROBOT, f)(const double**, double**, long long*, double*, int);
DECLARE(_rnea) DECLARE(_crba) DECLARE(_aba) DECLARE(_centroidal_map)

int main(int argc, char** argv) {
  if (argc < 4) { std::fprintf(stderr, "usage: bench TAG MS ROBOT=DIR\n"); return 1; }
  const std::string s = argv[3], robot = s.substr(0, s.find('=')), dir = s.substr(s.find('=') + 1);
  const auto states = read_states(dir + "/" + robot + ".states");
  const size_t nv = states[0].v.size();
  std::vector<double> out(nv * nv), work(200000);
  std::vector<long long> iwork(100);
  auto call = [&](auto f, const State& x, const std::vector<double>& third) {
    const double* in[3] = {x.q.data(), x.v.data(), third.data()};
    double* res[1] = {out.data()};
    f(in, res, iwork.data(), work.data(), 0);
    sink(out.data());
  };
  auto T = [&](const char* fn, auto&& f) { time_it(robot.c_str(), fn, argv[1], std::atof(argv[2]), (int)states.size(), f); };
  T("rnea", [&](int i) { call(CAT(ROBOT, _rnea), states[i], states[i].a); });
  T("crba", [&](int i) { call(CAT(ROBOT, _crba), states[i], states[i].a); });
  T("aba", [&](int i) { call(CAT(ROBOT, _aba), states[i], states[i].tau); });
  T("centroidal_map", [&](int i) { call(CAT(ROBOT, _centroidal_map), states[i], states[i].a); });
  T("rnea_crba_aba", [&](int i) {
    call(CAT(ROBOT, _rnea), states[i], states[i].a);
    call(CAT(ROBOT, _crba), states[i], states[i].a);
    call(CAT(ROBOT, _aba), states[i], states[i].tau);
  });
}
