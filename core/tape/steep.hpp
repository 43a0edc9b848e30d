// Steep functions: exp, tanh, sinh, cosh and high powers change by orders of magnitude while their argument moves by a
// few units. A pulse e^{−k(t−a)²}, a bump, a wall or a switch tanh(kv) that lies ahead leaves no digit in a Taylor
// series or in the stages of a Runge–Kutta step, and a step chosen by error estimates alone may jump over it. But its
// argument is smooth and shows it: a step is resolved if no argument moves by more than a few e-foldings where its
// function matters.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/tape/program.hpp"

namespace least::tape {

/// Returns the kind of a steep function; nothing for the other functions.
constexpr std::optional<SteepArgument::Kind> steepness(Op function) {
  using Kind = SteepArgument::Kind;
  switch (function) {
    case Op::exp:
      return Kind::exponential;
    case Op::tanh:
      return Kind::saturating;
    case Op::sinh:
    case Op::cosh:
      return Kind::hyperbolic;
    default:
      return std::nullopt;
  }
}

/// Returns the steep functions on which the motion of a program depends; their arguments are values of the program.
std::vector<SteepArgument> steep_arguments(const Program& program);
/// Returns the steep functions on which the outputs depend; their arguments are nodes of the tape, which has no terms.
std::vector<SteepArgument> steep_arguments(const Tape& tape, std::span<const Index> outputs);

/// Whether the motion of a program may change abruptly ahead although no steep function tells of it: it depends on
/// polynomials or quotients of high degree, or on roots of x or x² + ε², whose singularities may be arbitrarily faint.
bool may_conceal(const Program& program);
/// Returns the values of which the motion takes roots or other powers between 0 and 1. Where they vanish, the motion
/// may branch.
std::vector<Index> branch_values(const Program& program);

/// SteepLooks are samples of an argument at `steep_looks` equally spaced times of a step, both ends included.
inline constexpr std::size_t steep_looks = 17;
using SteepLooks = std::array<double, steep_looks>;

/// The most e-foldings that a steep argument may move in a step of a series of high order, and in a step of a
/// Runge–Kutta pair, whose error estimate has to notice them.
inline constexpr double most_of_series = 12, most_of_pair = 2;

/// Returns the time, at most h, in which an argument moves by `most` e-foldings, up and down added up: a step of the
/// length h is resolved that far. `value(time)` is the argument at a time from the beginning of the step, and `looks`
/// are its samples. Extrema between samples are found by parabolas.
template <class Value>
double resolved_length(const SteepArgument& steep, double h, double most, const SteepLooks& looks, Value&& value) {
  struct Look {
    double time, value;
  };
  constexpr int refinements = 5, halvings = 40;
  std::array<Look, 2 * steep_looks> way;  // NOLINT: written before it is read
  std::size_t count = 0;
  const auto time = [h](std::size_t i) { return h * static_cast<double>(i) / (steep_looks - 1); };
  const auto look = [&](std::size_t i) { return Look{time(i), looks[i]}; };
  // Parabolas through three looks, again and again: each extremum replaces one of the outer looks.
  const auto add_extremum = [&](Look a, Look b, Look c, double low, double high) {
    bool found = false;
    for (int i = 0; i < refinements; ++i) {
      const double left = (b.time - a.time) * (b.value - c.value), right = (b.time - c.time) * (b.value - a.value);
      const double t = b.time - 0.5 * ((b.time - a.time) * left - (b.time - c.time) * right) / (left - right);
      if (!(t > low && t < high) || t == a.time || t == b.time || t == c.time) break;
      const Look here{t, value(t)};
      const bool peak = b.value > a.value || b.value > c.value, beyond = (here.value > b.value) == peak;
      Look& drawn_in = (t < b.time) == beyond ? c : a;
      drawn_in = beyond ? b : here;
      if (beyond) b = here;
      found = true;
    }
    if (found) way[count++] = b;
  };
  for (std::size_t i = 0; i < steep_looks; ++i) {
    const bool first = i == 0, last = i + 1 == steep_looks;
    const std::size_t middle = first ? 1 : last ? i - 1 : i;
    if (first || last || (looks[i] - looks[i - 1]) * (looks[i + 1] - looks[i]) < 0)
      add_extremum(look(middle - 1), look(middle), look(middle + 1), time(first ? 0 : i - 1), time(last ? i : i + 1));
    way[count++] = look(i);
  }
  std::sort(way.begin(), way.begin() + count, [](const Look& a, const Look& b) { return a.time < b.time; });
  double moved = 0;
  for (std::size_t i = 1; i < count; ++i) {
    const double from = steep.foldings(way[i - 1].value), by = std::abs(steep.foldings(way[i].value) - from);
    if (!(moved + by > most)) {
      if (by > 0) moved += by;  // else it is NaN there
      continue;
    }
    double low = way[i - 1].time, high = way[i].time;
    for (int k = 0; k < halvings; ++k) {
      const double t = 0.5 * (low + high);
      (moved + std::abs(steep.foldings(value(t)) - from) > most ? high : low) = t;
    }
    return low > 0 ? low : high;
  }
  return h;
}

/// SteepStep is a step of a method without series, with states and rates at both ends. The first `moving` of its
/// `components` are the motion and the first variables of the tape.
struct SteepStep {
  struct End {
    double t;
    const double* state;
    const double* rate;
  };
  End start, end;
  std::size_t moving, components;
  void (*rate)(const void* problem, double t, const double* state, double* rate);
  /// Writes those variables of the tape that are functions of the others; null if there are none.
  void (*complete)(const void* problem, double t, double* variables) = nullptr;
  const void* problem = nullptr;
  double least_size = 1;  ///< size of a state below which its error is absolute
};

/// SteepForces finds what a step controlled by error estimates alone may jump over in equations of motion on a tape:
/// steep functions, and zeros at which the choice between two formulas changes. The tape has no terms (PlainTape):
/// their operands are not followed.
class SteepForces {
 public:
  SteepForces(const Tape& tape, std::span<const Index> rates);

  bool empty() const { return steep_.empty() && switches_.outputs() == 0; }
  /// Returns how much of the step, in time, is resolved (or somewhat less), at most up to the first change of a choice.
  /// The step is examined along the cubic Hermite polynomials through its ends. Where the slopes of these differ from
  /// the rates by more than the tolerance allows, half of the step is returned. `evaluations` is increased by the
  /// number of rates evaluated for that.
  double resolved_part(const SteepStep& step, double tolerance, std::int64_t& evaluations) const;

 private:
  double resolved_length(const SteepStep& step) const;
  double until_switch(const SteepStep& step, double tolerance) const;

  std::vector<SteepArgument> steep_;
  Formula arguments_, switches_;  ///< of the steep functions; values whose signs make the choices
  std::size_t variables_;         ///< of the tape
};

}  // namespace least::tape
