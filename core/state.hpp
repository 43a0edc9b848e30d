// The state of a mechanical scene and nothing that the scene does not need.
#pragma once

#include "core/number/math.hpp"

namespace least {

/// Absent action: a conservative scene carries no s.
struct NoAction {
  friend constexpr bool operator==(const NoAction&, const NoAction&) = default;
};
/// The action s of a contact scene, where the motion needs it or the caller asks for it.
template <class T>
struct Action {
  T s{};
  friend constexpr bool operator==(const Action&, const Action&) = default;
};

/// Time t, coordinates q, momenta p, and s where A says so. N degrees of freedom; T is what the state is made of, S
/// what time is.
template <int N, class T = double, class S = double, class A = NoAction>
struct State {
  using Number = T;
  using Time = S;
  static constexpr int dof = N;
  S t{};
  Vec<N, T> q{}, p{};
  [[no_unique_address]] A action{};
  friend constexpr bool operator==(const State&, const State&) = default;
};
static_assert(sizeof(State<1>) == 3 * sizeof(double));

/// The same state in another number; derivatives are zero, digits are kept.
template <class T, class S, int N, class T0, class S0>
constexpr State<N, T, S> convert(const State<N, T0, S0>& x) {
  State<N, T, S> y;
  y.t = S(x.t);
  for (std::size_t i = 0; i < N; ++i) {
    y.q[i] = T(x.q[i]);
    y.p[i] = T(x.p[i]);
  }
  return y;
}

}  // namespace least
