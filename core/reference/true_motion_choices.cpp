// How TrueMotion treats choices between two formulas, that is, from which one a series is made and where the motion
// leaves its side; and poles of the rates.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/reference/true_motion.hpp"
#include "core/tape/side_change.hpp"

namespace least {
namespace {

/// Margin is the series of the value that decides a choice, as a polynomial of the time, with the sign that makes it
/// positive on the side of the series.
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
  /// The value at a time, computed in double-double.
  double exactly(double time) const {
    DoubleDouble sum{};
    for (std::size_t k = orders; k-- > 0;) sum = sum * DoubleDouble(time) + c[k];
    return sign * sum.high();
  }
  /// Returns the first double at which positive(time) no longer holds, by bisection between `low` and `high`.
  template <class F>
  static double border(F&& positive, double low, double high) {
    constexpr int halvings = 1100;  // as many lead from any double to the smallest one
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      if (!(low < middle && middle < high)) break;
      (positive(middle) ? low : high) = middle;
    }
    return high;
  }
};

/// Returns the size below which a deciding value counts as zero: by the size of its series, and if the value is a sum,
/// by the sizes of its two summands. at(i) is the size of node i.
template <class At>
double nothing_beside(double size, const tape::Tape& tape, tape::Index value, At&& at) {
  constexpr double part = 1e-26, rounding = 1e-31;
  const tape::Node& node = tape[value];
  const bool sum = node.op == tape::Op::add || node.op == tape::Op::subtract;
  return part * size + (sum ? rounding * (at(node.a) + at(node.b)) : 0);
}

}  // namespace

/// Sets the sides of all choices at the expansion point. Returns whether a side has changed, so that the series has to
/// be computed anew. The side of a value that vanishes there is the one to which it moves.
bool TrueMotion::take_sides() {
  constexpr double still = 1e-20;  // relative to the series: smaller coefficients count as zero
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

/// Shortens a step h so that it does not lead over a pole of the rates, whatever the last coefficients suggest, unless
/// they show that there is no pole: each coefficient of R/(t − t*) determines R.
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

/// Returns a bound of the change of the deciding value until `end`.
double TrueMotion::most_change(const Choice& choice, double end) const {
  double most = 0;
  for (std::size_t k = order_; k-- > 1;) most = (most + std::abs(row(choice.by)[k].high())) * end;
  return most;
}

/// Returns the first time up to `end`, in units, at which the deciding value has left the side of the series, else
/// `end`. The value is examined at `looks` times, and where it turns back between two of them. A value that only
/// touches zero stays on its side.
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
      // The value begins at zero, where rounding decides on its side, and first moves away from there.
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

/// Returns a step of at most `end` within which the series of the deciding value is accurate: the value may change much
/// faster than the motion, as where only the sign of sin(20t) acts.
double TrueMotion::told_until(const Choice& choice, double end) const {
  if (most_change(choice, end) < std::abs(row(choice.by)[0].high())) return end;
  std::array<double, tape::most_terms> terms{};
  for (std::size_t k = 0; k < order_; ++k) terms[k] = row(choice.by)[k].high();
  return tape::told_until({terms.data(), order_}, end, tolerance_);
}

/// Shortens the step up to the first change. A length is a double, so the step ends a little before the change, and the
/// next step, whose length is so short that all its digits count, ends there.
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
