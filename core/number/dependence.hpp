// Dependence is a number that knows only whether something, such as the time, has entered it. Mechanics evaluated with
// it at compile time tell whether they depend on that, whatever the values: 0·t counts as dependent.
#pragma once

#include <concepts>
#include <type_traits>
#include <utility>

namespace least {

struct Dependence {
  bool touched = false;

  constexpr Dependence() = default;
  template <class U>
  requires std::is_arithmetic_v<U>
  constexpr Dependence(const U&) {}  // NOLINT: a constant depends on nothing
  static constexpr Dependence touching() {
    Dependence t;
    t.touched = true;
    return t;
  }

  constexpr Dependence operator-() const { return *this; }
  friend constexpr Dependence operator|(Dependence a, const Dependence& b) {
    a.touched = a.touched || b.touched;
    return a;
  }
  friend constexpr Dependence operator+(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator-(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator*(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator/(const Dependence& a, const Dependence& b) { return a | b; }
  constexpr Dependence& operator+=(const Dependence& b) { return *this = *this | b; }
  constexpr Dependence& operator-=(const Dependence& b) { return *this = *this | b; }
  constexpr Dependence& operator*=(const Dependence& b) { return *this = *this | b; }
  constexpr Dependence& operator/=(const Dependence& b) { return *this = *this | b; }

  // A comparison is no bool, as with lanes: both branches are evaluated.
  friend constexpr Dependence operator<(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator<=(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator>(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator>=(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator&(const Dependence& a, const Dependence& b) { return a | b; }
  friend constexpr Dependence operator!(const Dependence& a) { return a; }
  friend constexpr Dependence select(const Dependence& mask, const Dependence& yes, const Dependence& no) {
    return mask | yes | no;
  }

  friend constexpr Dependence sin(const Dependence& x) { return x; }
  friend constexpr Dependence cos(const Dependence& x) { return x; }
  friend constexpr std::pair<Dependence, Dependence> sincos(const Dependence& x) { return {x, x}; }
  friend constexpr Dependence exp(const Dependence& x) { return x; }
  friend constexpr Dependence log(const Dependence& x) { return x; }
  friend constexpr Dependence tanh(const Dependence& x) { return x; }
  friend constexpr Dependence sqrt(const Dependence& x) { return x; }
  friend constexpr Dependence abs(const Dependence& x) { return x; }
  friend constexpr Dependence phi1(const Dependence& x) { return x; }
  friend constexpr Dependence pow(const Dependence& x, const Dependence& y) { return x | y; }
};

}  // namespace least
