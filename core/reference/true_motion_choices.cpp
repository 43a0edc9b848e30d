// Where formulas change on the way of a motion: which of the two a series is made of, and when that ends; and where
// they end.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/reference/true_motion.hpp"
#include "core/tape/side_change.hpp"

namespace least {
namespace {

/// The change by which one side is left, as a polynomial of the time: positive on the side of the series.
struct Margin {
  const DoubleDouble* c;
  std::size_t orders;
  double sign;

  double at(double time) const {
    double sum = 0;
    for (std::size_t k = orders; k-- > 0;) sum = sum * time + c[k].high();
    return sign * sum;
  }
  double slope(double time) const {
    double sum = 0;
    for (std::size_t k = orders; k-- > 1;) sum = sum * time + static_cast<double>(k) * c[k].high();
    return sign * sum;
  }
  /// To all digits.
  double exactly(double time) const {
    DoubleDouble sum{};
    for (std::size_t k = orders; k-- > 0;) sum = sum * DoubleDouble(time) + c[k];
    return sign * sum.high();
  }
  /// Where it, or its slope, changes its sign between two times, as a number beyond the change.
  template <class F>
  static double border(F&& positive, double low, double high) {
    constexpr int halvings = 1100;  // so many lead from any number to the least one
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      if (!(low < middle && middle < high)) break;
      (positive(middle) ? low : high) = middle;
    }
    return high;
  }
};

/// What is nothing beside a series of this size, and beside the two numbers that its value is a sum of. `at(i)`: the
/// size of what stands at a place of the tape.
template <class At>
double nothing_beside(double size, const tape::Tape& tape, tape::Index value, At&& at) {
  constexpr double part = 1e-26, rounding = 1e-31;
  const tape::Node& node = tape[value];
  const bool sum = node.op == tape::Op::add || node.op == tape::Op::subtract;
  return part * size + (sum ? rounding * (at(node.a) + at(node.b)) : 0);
}

}  // namespace

/// Whether a series has to be made anew, of other sides: of a value that vanishes at its beginning the side is where it
/// goes.
bool TrueMotion::take_sides() {
  constexpr double still = 1e-20;  // of the series
  constexpr int most_turns = 2;
  const auto size_at = [this](tape::Index i) { return std::abs(row(i)[0].high()); };
  bool anew = false;
  for (Choice& choice : choices_) {
    const DoubleDouble* const c = row(choice.by);
    double size = 0;
    for (std::size_t k = 1; k < order_; ++k) size += std::abs(c[k].high());
    bool first = choice.first;
    if (std::abs(c[0].high()) > nothing_beside(size, tape_, choice.by, size_at)) {
      first = c[0].high() < 0;
    } else {
      std::size_t k = 1;
      while (k < order_ && !(std::abs(c[k].high()) > still * size)) ++k;
      if (k < order_) first = c[k].high() < 0;
    }
    if (first == choice.first) continue;
    choice.first = first;
    anew = true;
    if (++choice.turns > most_turns) stuck_ = true;
  }
  return anew;
}

/// No step leads over a place where rates are infinite, whatever the last coefficients say, unless they say that it is
/// none: of R/(t − t*) each of them tells R.
double TrueMotion::until_pole(double h, std::size_t used) const {
  constexpr double none = 1e-28;
  constexpr std::size_t looked_at = 3;
  for (const tape::Index pole : poles_) {
    const double ahead = -row(pole)[0].high() / row(pole)[1].high();
    if (!(ahead > 0 && 0.5 * ahead < h)) continue;
    double most = 0;
    for (std::size_t k = used; k > 0 && k + looked_at > used; --k)
      most = std::max(most, static_cast<double>(k) * largest(k) * std::pow(ahead, static_cast<double>(k)));
    if (!(most <= none * std::max(least_size_, largest(0)))) h = 0.5 * ahead;
  }
  return h;
}

/// How much what a choice is made by changes until then, at most.
double TrueMotion::most_change(const Choice& choice, double end) const {
  double most = 0;
  for (std::size_t k = order_; k-- > 1;) most = (most + std::abs(row(choice.by)[k].high())) * end;
  return most;
}

/// The first time up to `end`, in units, at which a value has left the side of the series; else `end`. It is looked for
/// between so many looks, and where the value turns back between two of them: where it only touches zero it stays.
double TrueMotion::change_of(const Choice& choice, double end) const {
  constexpr int looks = 16;
  const DoubleDouble* const c = row(choice.by);
  const double most = most_change(choice, end);
  if (!(most >= std::abs(c[0].high()))) return end;
  const auto size_at = [this](tape::Index i) { return std::abs(row(i)[0].high()); };
  const double nothing = nothing_beside(most, tape_, choice.by, size_at);
  const Margin margin{c, order_, choice.first ? -1.0 : 1.0};
  const auto kept = [&](double time) { return margin.at(time) >= 0; };
  double before = 0, slope = margin.slope(0);
  for (int look = 1; look <= looks; ++look) {
    const double time = end * look / looks, next = margin.slope(time);
    double low = before, high = time;
    if (slope < 0 && next > 0) high = Margin::border([&](double t) { return margin.slope(t) < 0; }, before, time);
    if (!kept(high) && margin.exactly(high) < -nothing) {
      // From the border itself, where rounding decides on which side it is, the value first goes away.
      if (before == 0 && slope > 0) {
        low = Margin::border([&](double t) { return margin.slope(t) > 0; }, 0, high);
        if (!kept(low)) low = 0;
      }
      return Margin::border(kept, low, high);
    }
    before = time;
    slope = next;
  }
  return end;
}

/// A step no longer than `end` within which the series of what a choice is made by says what that is: the motion may be
/// much slower, as where the sign of sin(20t) alone acts.
double TrueMotion::told_until(const Choice& choice, double end) const {
  if (most_change(choice, end) < std::abs(row(choice.by)[0].high())) return end;
  std::array<double, tape::most_terms> terms{};
  for (std::size_t k = 0; k < order_; ++k) terms[k] = row(choice.by)[k].high();
  return tape::told_until({terms.data(), order_}, end, tolerance_);
}

/// Shortens the step up to the first change. Its time is a double: the step ends a little before it, and the next one,
/// which is so short that all digits of its length count, there.
void TrueMotion::until_change() {
  constexpr double shortly = 1e-11;
  const Choice* next = nullptr;
  double end = length_;
  for (const Choice& choice : choices_)
    if (const double change = change_of(choice, end); change < end) {
      end = change;
      next = &choice;
    }
  if (!next || end <= shortly) {
    length_ = end;
    return;
  }
  const Margin margin{row(next->by), order_, next->first ? -1.0 : 1.0};
  double before = 1e-13;
  while (before < 0.5 && !(margin.exactly(end * (1 - before)) > 0)) before *= 16;
  length_ = end * (1 - before);
}

}  // namespace least
