// A toy lane number: four doubles that move together. It has no conversion to bool and lives outside namespace least,
// so that a problem or scheme that branches on a number, or does not find its functions by argument-dependent lookup,
// does not compile.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "core/number/linear.hpp"
#include "core/status.hpp"

namespace toy {

inline constexpr std::size_t width = 4;

struct Mask {
  std::array<bool, width> on{};
};
struct Lanes {
  std::array<double, width> v{};
  Lanes() = default;
  Lanes(double x) { v.fill(x); }  // NOLINT: a constant in every lane
};

template <class F>
Lanes map(const Lanes& a, F&& f) {
  Lanes r;
  for (std::size_t i = 0; i < width; ++i) r.v[i] = f(a.v[i]);
  return r;
}
template <class F>
Lanes zip(const Lanes& a, const Lanes& b, F&& f) {
  Lanes r;
  for (std::size_t i = 0; i < width; ++i) r.v[i] = f(a.v[i], b.v[i]);
  return r;
}
template <class F>
Mask compare(const Lanes& a, const Lanes& b, F&& f) {
  Mask r;
  for (std::size_t i = 0; i < width; ++i) r.on[i] = f(a.v[i], b.v[i]);
  return r;
}

inline Lanes operator-(const Lanes& a) {
  return map(a, [](double x) { return -x; });
}
inline Lanes operator+(const Lanes& a, const Lanes& b) {
  return zip(a, b, [](double x, double y) { return x + y; });
}
inline Lanes operator-(const Lanes& a, const Lanes& b) {
  return zip(a, b, [](double x, double y) { return x - y; });
}
inline Lanes operator*(const Lanes& a, const Lanes& b) {
  return zip(a, b, [](double x, double y) { return x * y; });
}
inline Lanes operator/(const Lanes& a, const Lanes& b) {
  return zip(a, b, [](double x, double y) { return x / y; });
}
inline Lanes& operator+=(Lanes& a, const Lanes& b) { return a = a + b; }
inline Lanes& operator-=(Lanes& a, const Lanes& b) { return a = a - b; }
inline Lanes& operator*=(Lanes& a, const Lanes& b) { return a = a * b; }
inline Lanes& operator/=(Lanes& a, const Lanes& b) { return a = a / b; }
inline Mask operator<(const Lanes& a, const Lanes& b) {
  return compare(a, b, [](double x, double y) { return x < y; });
}
inline Mask operator>(const Lanes& a, const Lanes& b) { return b < a; }
inline Mask operator<=(const Lanes& a, const Lanes& b) {
  return compare(a, b, [](double x, double y) { return x <= y; });
}
inline Mask operator>=(const Lanes& a, const Lanes& b) { return b <= a; }
inline Mask operator!(Mask m) {
  for (bool& on : m.on) on = !on;
  return m;
}
inline Mask operator&(Mask a, const Mask& b) {
  for (std::size_t i = 0; i < width; ++i) a.on[i] = a.on[i] && b.on[i];
  return a;
}
inline bool any(const Mask& m) {
  for (const bool on : m.on)
    if (on) return true;
  return false;
}
inline bool all(const Mask& m) { return !any(!m); }
inline Lanes select(const Mask& m, const Lanes& yes, const Lanes& no) {
  Lanes r;
  for (std::size_t i = 0; i < width; ++i) r.v[i] = m.on[i] ? yes.v[i] : no.v[i];
  return r;
}

inline Lanes sin(const Lanes& a) {
  return map(a, [](double x) { return std::sin(x); });
}
inline Lanes cos(const Lanes& a) {
  return map(a, [](double x) { return std::cos(x); });
}
inline std::pair<Lanes, Lanes> sincos(const Lanes& a) { return {sin(a), cos(a)}; }
inline Lanes exp(const Lanes& a) {
  return map(a, [](double x) { return std::exp(x); });
}
inline Lanes log(const Lanes& a) {
  return map(a, [](double x) { return std::log(x); });
}
inline Lanes sqrt(const Lanes& a) {
  return map(a, [](double x) { return std::sqrt(x); });
}
inline Lanes pow(const Lanes& a, double y) {
  return map(a, [y](double x) { return std::pow(x, y); });
}
inline Lanes pow(const Lanes& a, const Lanes& b) {
  return zip(a, b, [](double x, double y) { return std::pow(x, y); });
}
inline Lanes floor(const Lanes& a) {
  return map(a, [](double x) { return std::floor(x); });
}
inline Lanes tanh(const Lanes& a) {
  return map(a, [](double x) { return std::tanh(x); });
}
inline Lanes phi1(const Lanes& a) {
  return map(a, [](double x) { return least::phi1(x); });
}
inline Lanes abs(const Lanes& a) {
  return map(a, [](double x) { return std::fabs(x); });
}

/// Statuses holds the status of each lane.
struct Statuses {
  std::array<least::StepStatus, width> of{};
  Statuses(least::StepStatus all) { of.fill(all); }  // NOLINT: one for all
};
inline Mask succeeded(const Statuses& status) {
  Mask r;
  for (std::size_t i = 0; i < width; ++i) r.on[i] = least::succeeded(status.of[i]);
  return r;
}
inline bool all_failed(Statuses& status, const Mask& where, least::StepStatus why) {
  bool all = true;
  for (std::size_t i = 0; i < width; ++i) {
    if (where.on[i] && status.of[i] == least::StepStatus::ok) status.of[i] = why;
    all = all && status.of[i] != least::StepStatus::ok;
  }
  return all;
}
/// all_failed() with one condition for all lanes: where it holds, every lane that is still ok fails with `why`.
inline bool all_failed(Statuses& status, bool where, least::StepStatus why) {
  Mask all;
  all.on.fill(where);
  return all_failed(status, all, why);
}

}  // namespace toy

template <>
struct least::StatusFor<toy::Lanes> {
  using type = toy::Statuses;
};
template <>
struct least::Precision<toy::Lanes> : least::Precision<double> {};

template <>
struct least::LinearSolver<toy::Lanes> {
  template <std::size_t N>
  static std::array<toy::Lanes, N> solve(const std::array<std::array<toy::Lanes, N>, N>& a,
                                         const std::array<toy::Lanes, N>& b) {
    std::array<toy::Lanes, N> x;
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      std::array<std::array<double, N>, N> m;
      std::array<double, N> r;
      for (std::size_t i = 0; i < N; ++i) {
        r[i] = b[i].v[lane];
        for (std::size_t j = 0; j < N; ++j) m[i][j] = a[i][j].v[lane];
      }
      const auto y = LinearSolver<double>::solve(m, r);
      for (std::size_t i = 0; i < N; ++i) x[i].v[lane] = y[i];
    }
    return x;
  }
};
