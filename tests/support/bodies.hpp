// Bodies that attract each other with the softened potential −1/(n √(r² + .01)), moved by a plain loop over pairs: the
// reference against which scenes of many bodies are checked.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace bodies {

/// State holds the positions q and momenta p of n bodies of mass 1, axis by axis: q[a n + i] is coordinate a of body i.
struct State {
  std::size_t n;
  std::vector<double> q, p;

  State(std::size_t bodies, std::size_t axes) : n(bodies), q(axes * bodies), p(q.size(), 0.0) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = std::sin(7.3 * static_cast<double>(i));
  }
  std::vector<double> together() const {
    std::vector<double> all = q;
    all.insert(all.end(), p.begin(), p.end());
    return all;
  }
};

inline void kick(State& x, double by) {
  constexpr double softening = 0.01;
  std::vector<double> force(x.q.size(), 0.0);
  for (std::size_t i = 0; i < x.n; ++i)
    for (std::size_t j = i + 1; j < x.n; ++j) {
      double square = softening;
      for (std::size_t a = 0; a < x.q.size(); a += x.n) square += std::pow(x.q[a + i] - x.q[a + j], 2);
      for (std::size_t a = 0; a < x.q.size(); a += x.n) {
        const double pull = (x.q[a + i] - x.q[a + j]) / (static_cast<double>(x.n) * square * std::sqrt(square));
        force[a + i] -= pull;
        force[a + j] += pull;
      }
    }
  for (std::size_t i = 0; i < x.p.size(); ++i) x.p[i] += by * force[i];
}
/// leapfrog() makes `steps` steps of length h, each kick, drift, kick.
inline void leapfrog(State& x, double h, int steps) {
  for (int step = 0; step < steps; ++step) {
    kick(x, h / 2);
    for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] += h * x.p[i];
    kick(x, h / 2);
  }
}

}  // namespace bodies
