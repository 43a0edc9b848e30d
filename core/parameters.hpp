// The parameters of a problem in another number type. A problem is an aggregate, so its members are reached in the
// order of their declaration; the member that a field of its card means is recognized by its address.
#pragma once

#include <tuple>
#include <type_traits>
#include <utility>

#include "core/describe.hpp"

namespace least::parameters {

template <class P>
inline constexpr std::size_t count = 0;
template <template <class> class P, class R>
inline constexpr std::size_t count<P<R>> = std::tuple_size_v<std::remove_cvref_t<decltype(About<P>::fields)>>;

/// members(problem) returns references to the members in the order of their declaration. It compiles only if the card
/// has one field for each member.
template <class P>
constexpr auto members(P& problem) {
  constexpr std::size_t n = count<std::remove_const_t<P>>;
  static_assert(n > 0 && n < 7, "a line for as many parameters is wanted here");
  if constexpr (n == 1) {
    auto& [a] = problem;
    return std::tie(a);
  } else if constexpr (n == 2) {
    auto& [a, b] = problem;
    return std::tie(a, b);
  } else if constexpr (n == 3) {
    auto& [a, b, c] = problem;
    return std::tie(a, b, c);
  } else if constexpr (n == 4) {
    auto& [a, b, c, d] = problem;
    return std::tie(a, b, c, d);
  } else if constexpr (n == 5) {
    auto& [a, b, c, d, e] = problem;
    return std::tie(a, b, c, d, e);
  } else {
    auto& [a, b, c, d, e, f] = problem;
    return std::tie(a, b, c, d, e, f);
  }
}

/// Calls f(member of a, same member of b) for each member; the two may be made of different numbers.
template <class A, class B, class F>
constexpr void for_each_pair(A& a, B& b, F&& f) {
  const auto from = members(a);
  const auto to = members(b);
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::get<I>(from), std::get<I>(to)), ...); }
  (std::make_index_sequence<std::tuple_size_v<std::remove_const_t<decltype(from)>>>{});
}

/// in<R>(problem) returns the same problem in the number R: each number is converted, choices are copied.
template <class R, template <class> class P>
constexpr P<R> in(const P<double>& problem) {
  P<R> wide;
  for_each_pair(problem, wide, [](const auto& from, auto& to) { to = std::remove_cvref_t<decltype(to)>(from); });
  return wide;
}

/// Calls f(field) for each parameter that is a number.
template <template <class> class P, class F>
constexpr void for_each_number(F&& f) {
  const auto one = [&]<class M>(const Field<P<double>, M>& field) {
    if constexpr (std::is_same_v<M, double>) f(field);
  };
  std::apply([&](const auto&... field) { (one(field), ...); }, About<P>::fields);
}

/// Calls f with the member of `wide` that `field` describes; `wide` may be made of another number than the card.
template <template <class> class P, class R, class F>
constexpr void with_member(P<R>& wide, const Field<P<double>>& field, F&& f) {
  P<double> narrow;
  for_each_pair(narrow, wide, [&](auto& from, auto& to) {
    if constexpr (std::is_same_v<decltype(from), double&>)
      if (&from == &(narrow.*field.member)) f(to);
  });
}

}  // namespace least::parameters
