// The state of a scene, without components that the scene does not need. A state is read either by its parts (q, p, s
// or y), as mechanics does, or by its components x[0] … x[size − 1], as generic code does.
#pragma once

#include <type_traits>

#include "core/number/math.hpp"

namespace least {

/// NoAction stands for the action of a state that does not carry s: the motion does not read s and nobody asked for it.
struct NoAction {
  template <class>
  using in = NoAction;
  static constexpr std::size_t size = 0;
  friend constexpr bool operator==(const NoAction&, const NoAction&) = default;
};
/// The action s of a contact scene, where the motion needs it or the caller asks for it.
template <class T>
struct Action {
  template <class U>
  using in = Action<U>;
  static constexpr std::size_t size = 1;
  T s{};
  friend constexpr bool operator==(const Action&, const Action&) = default;
};

/// State holds time t, coordinates q, momenta p, and s if A is Action. N degrees of freedom; T is the number type of q,
/// p and s, S that of time. Components in order: q, p, s.
template <int N, class T = double, class S = double, class A = NoAction>
struct State {
  using Number = T;
  using Time = S;
  template <class U, class V = U>
  using in = State<N, U, V, typename A::template in<U>>;  ///< the same state in other numbers
  static constexpr int dof = N;
  static constexpr bool acting = A::size > 0;
  static constexpr std::size_t size = 2 * N + A::size;

  S t{};
  Vec<N, T> q{}, p{};
  [[no_unique_address]] A action{};

  template <class Self>
  static constexpr auto& component(Self& x, std::size_t i) {
    if constexpr (acting)
      if (i == 2 * N) return x.action.s;
    return i < N ? x.q[i] : x.p[i - N];
  }
  constexpr T& operator[](std::size_t i) { return component(*this, i); }
  constexpr const T& operator[](std::size_t i) const { return component(*this, i); }
  friend constexpr bool operator==(const State&, const State&) = default;
};
static_assert(sizeof(State<1>) == 3 * sizeof(double));

/// Extended is a point (q, t; p, p_t; s) of the extended space of a contact scene with n degrees of freedom; its own
/// time member is not used.
template <class P, class T = double>
using Extended = State<P::dof + 1, T, T, Action<T>>;

/// Point holds time t and a point y of the phase space of a system that is not mechanical.
template <int N, class T = double, class S = double>
struct Point {
  using Number = T;
  using Time = S;
  template <class U, class V = U>
  using in = Point<N, U, V>;
  static constexpr bool acting = false;
  static constexpr std::size_t size = N;

  S t{};
  Vec<N, T> y{};

  constexpr T& operator[](std::size_t i) { return y[i]; }
  constexpr const T& operator[](std::size_t i) const { return y[i]; }
  friend constexpr bool operator==(const Point&, const Point&) = default;
};

/// convert returns the same state in another number type, all digits kept and with zero derivatives.
template <class T, class S, class X>
constexpr typename X::template in<T, S> convert(const X& x) {
  typename X::template in<T, S> y;
  y.t = S(x.t);
  for (std::size_t i = 0; i < X::size; ++i) y[i] = T(x[i]);
  return y;
}

/// assign copies t and the components that two states share; the other components of `to` stay as they are.
template <class To, class From>
constexpr To& assign(To& to, const From& from) {
  to.t = from.t;
  for (std::size_t i = 0; i < (To::size < From::size ? To::size : From::size); ++i) to[i] = from[i];
  return to;
}

}  // namespace least
