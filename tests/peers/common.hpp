// What both peer benches share: reading the states, the clock, the median.
#pragma once
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

// One random state: configuration, velocity, acceleration, torque.
struct State { std::vector<double> q, v, a, tau; };

inline std::vector<State> read_states(const std::string& path) {
  std::ifstream f(path);
  int n = 0, nq = 0, nv = 0;
  if (!(f >> n >> nq >> nv)) { std::fprintf(stderr, "cannot read %s\n", path.c_str()); std::exit(2); }
  std::vector<State> s(n);
  auto read = [&](std::vector<double>& x, int k) { x.resize(k); for (auto& y : x) f >> y; };
  for (auto& x : s) { read(x.q, nq); read(x.v, nv); read(x.a, nv); read(x.tau, nv); }
  return s;
}

// Thread CPU time in ns: a preempted batch on a shared machine is not charged.
inline double now() { timespec t; clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t); return t.tv_sec * 1e9 + t.tv_nsec; }

inline void sink(const void* p) { asm volatile("" : : "r"(p) : "memory"); }

// Calls `call(i)` over all states, batch after batch, for `ms` of CPU time; prints robot,function,median ns per call,batches,tag.
template <typename F>
void time_it(const char* robot, const char* fn, const char* tag, double ms, int states, F&& call) {
  std::vector<double> t;
  for (int i = 0; i < states; ++i) call(i);
  const double end = now() + ms * 1e6;
  while (t.size() < 5 || now() < end) {
    const double start = now();
    for (int i = 0; i < states; ++i) call(i);
    t.push_back((now() - start) / states);
  }
  std::nth_element(t.begin(), t.begin() + t.size() / 2, t.end());
  std::printf("%s,%s,%.2f,%zu,%s\n", robot, fn, t[t.size() / 2], t.size(), tag);
  std::fflush(stdout);
}
