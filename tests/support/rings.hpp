// Toda's lattice closed to a ring and held by springs, with friction or without, as a text of any size and as a
// compiled problem.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/problem_traits.hpp"
#include "tests/support/sized.hpp"

namespace rings {

using namespace sized;

/// `timed`: the friction changes in time, and the first coordinate is driven.
enum class Friction { none, constant, timed };
constexpr Friction frictions[] = {Friction::none, Friction::constant, Friction::timed};
constexpr double alpha = 0.3, spring = 0.4, coupling = 0.2;

struct Variant {
  bool coupled = false;    ///< the kinetic energy couples momenta; else masses are unequal
  double held = spring;    ///< the strength of the springs
  double damping = alpha;  ///< the strength of the friction where there is some
};
inline std::shared_ptr<const Mechanics> ring(int n, Friction friction, const Variant& variant = {}) {
  text::TypedScene typed;
  std::string v = "sum(i=1..n, exp(q[i] - q[mod(i,n)+1]) + k*q[i]^4/4)";
  if (friction == Friction::timed) v += " - cos(2*t)*q[1]";
  const std::string a = friction == Friction::timed ? "alpha*(1 + sin(t)/2)" : "alpha";
  const std::vector<std::pair<std::string, double>> parameters{
      {"n", double(n)}, {"alpha", variant.damping}, {"k", variant.held}, {"c", coupling}};
  if (variant.coupled) {
    if (friction != Friction::none) v += " + " + a + "*s";
    typed.scene = of(Definition::Kind::hamiltonian, {"q[n]"}, parameters,
                     "sum(i=1..n, p[i]^2/2) + c*sum(i=1..n-1, p[i]*p[i+1]) + " + v);
  } else {
    typed.scene = of(Definition::Kind::potential, {"q[n]"}, parameters, v);
    typed.scene.masses = {{"q[i]", "1 + i/n"}};
    if (friction != Friction::none) typed.scene.damping = a;
  }
  return made(typed);
}
/// start() returns q, p, and s where there is friction.
inline std::vector<double> start(int n, Friction friction) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.7 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.6 * std::cos(3 * i));
  if (friction != Friction::none) x.push_back(0.3);
  return x;
}

template <int N, Friction friction, bool Coupled = false>
struct Ring {
  static constexpr int dof = N;

  template <class T, class S>
  constexpr T potential(const Vec<N, T>& q, [[maybe_unused]] const S& t) const {
    using least::cos;
    using least::exp;
    T sum(0);
    for (std::size_t i = 0; i < N; ++i)
      sum = sum + exp(q[i] - q[(i + 1) % N]) + spring * (q[i] * q[i]) * (q[i] * q[i]) / 4;
    if constexpr (friction == Friction::timed) sum = sum - cos(2 * t) * q[0];
    return sum;
  }
  Vec<N> inverse_mass() const {
    Vec<N> w;
    for (std::size_t i = 0; i < N; ++i) w[i] = 1 / (1 + double(i + 1) / N);
    return w;
  }
  bool has_full_mass() const { return Coupled; }
  template <class T>
  Vec<N, T> times_inverse_mass(const Vec<N, T>& p) const {
    Vec<N, T> v = p;
    for (std::size_t i = 0; i + 1 < N; ++i) {
      v[i] = v[i] + coupling * p[i + 1];
      v[i + 1] = v[i + 1] + coupling * p[i];
    }
    return v;
  }
  template <class T>
  Vec<N, T> times_mass(const Vec<N, T>& v) const {
    return v;  // explicit steps never call it
  }
  double damping() const requires(friction == Friction::constant) { return alpha; }
  template <class S>
  S damping(const S& t) const requires(friction == Friction::timed) {
    using least::sin;
    return alpha * (1 + sin(t) / 2);
  }
};

/// state_of() converts a list of the card's variables to a state of the compiled problem.
template <class X>
X state_of(const std::vector<double>& numbers) {
  X x;
  for (std::size_t i = 0; i < X::size; ++i) x[i] = numbers[i];
  return x;
}

}  // namespace rings
