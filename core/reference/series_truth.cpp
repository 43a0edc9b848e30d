#include "core/reference/series_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/reference/true_motion.hpp"
#include "core/run/still_components.hpp"
#include "core/schemes/expansion.hpp"

namespace least {
namespace {

constexpr std::size_t times_at_once = 256;

/// The states of two motions of the same equations, each one state after the other.
using TwoWays = std::array<std::vector<DoubleDouble>, 2>;

/// DoubleMotion integrates by Taylor series in double, with steps whose truncation errors are below rounding. The
/// polynomials give the states at the times asked for, at which steps do not end: two motions of different orders so
/// have different steps and different rounding errors.
class DoubleMotion {
 public:
  DoubleMotion(const tape::Program& program, int order, const std::vector<DoubleDouble>& start, double t)
      : series_(program, closest, order), t_(t), y_(start.size()), low_(y_.size()), end_(y_.size()), rest_(y_.size()) {
    std::ranges::transform(start, y_.begin(), &DoubleDouble::high);
  }

  int order() const { return series_.order(); }
  /// Appends the state at t, rounding errors included, to `states`; t must not be earlier than any time asked for
  /// before. Returns false where the motion does not go on, or if keep_going() does.
  bool append(double t, const KeepGoing& keep_going, std::vector<DoubleDouble>& states) {
    while (t_ + h_ < t)
      if (!keep_going() || !step()) return false;
    if (t > t_) {
      series_.evaluate(t - t_, y_.data(), low_.data(), end_.data(), rest_.data());
    } else {
      end_ = y_;
      rest_ = low_;
    }
    for (std::size_t i = 0; i < y_.size(); ++i) states.push_back(DoubleDouble::exact_sum(end_[i], rest_[i]));
    return true;
  }

 private:
  static constexpr double closest = 1e-15;

  /// Makes the next step, from the end of the last one. Its end is a double and a state with finite rates.
  bool step() {
    if (h_ > 0) series_.evaluate(h_, low_.data(), y_.data());
    t_ += h_;
    series_.move(y_.data(), t_);
    for (double h = series_.step(); h > 0; h *= 0.5) {
      h_ = (t_ + h) - t_;
      if (!(h_ > 0)) return false;
      series_.evaluate(h_, y_.data(), low_.data(), end_.data(), rest_.data());
      if (series_.defined(end_.data(), t_ + h_)) return true;
    }
    return false;
  }

  taylor::Expansion series_;
  double t_, h_ = 0;  ///< beginning and length of the last step
  std::vector<double> y_, low_, end_, rest_;
};

/// Two such motions, of which one has a higher order and so longer steps.
class TwoDoubleMotions {
 public:
  TwoDoubleMotions(const tape::Program& program, const std::vector<DoubleDouble>& start, double t)
      : one_(program, 0, start, t), other_(program, one_.order() + higher, start, t) {}

  TwoWays at(std::span<const double> times, const KeepGoing& keep_going) {
    TwoWays states;
    for (const double t : times)
      if (!one_.append(t, keep_going, states[0]) || !other_.append(t, keep_going, states[1])) break;
    return states;
  }

 private:
  static constexpr int higher = 4;
  DoubleMotion one_, other_;
};

/// Fills `truth` from two runs: at(times) returns the states of both at the next times, as far as each run goes.
template <class At>
Truth truth_of(const RunBackend& backend, const RunState& start, const std::vector<double>& times,
               const KeepGoing& keep_going, std::span<const std::size_t> kinds, Truth truth, At&& at) {
  constexpr double rounding = 0x1p-53;
  const std::size_t size = start.size(), all = backend.found() + size;
  ComponentSizes sizes(kinds, size);
  sizes.see(start);
  std::vector<RunState> seen{start};
  std::vector<double> doubts(size, 0);
  while (truth.states.size() < times.size()) {
    const auto ahead = std::span(times).subspan(truth.states.size());
    const auto [x, y] = at(ahead.first(std::min(times_at_once, ahead.size())));
    const std::size_t both = std::min(x.size(), y.size()) / all;
    bool finite = both > 0;
    for (std::size_t k = 0; k < both && finite; ++k) {
      const DoubleDouble *const here = &x[k * all], *const other = &y[k * all];
      RunState state{times[truth.states.size()], StateNumbers(size)};
      double apart = 0, largest = 1;
      for (std::size_t i = 0; i < size; ++i) {
        state[i] = here[i].high();
        const double doubt = std::abs((other[i] - here[i]).high());
        finite = finite && std::isfinite(state[i]) && std::isfinite(doubt);
        doubts[i] = std::max(doubts[i], doubt);
        apart = std::max(apart, doubt);
        largest = std::max(largest, std::abs(state[i]));
      }
      if (!finite) break;
      truth.uncertainty = std::max(truth.uncertainty, rounding + apart / largest);
      truth.states.emplace_back(state.numbers.begin(), state.numbers.end());
      sizes.see(state);
      seen.push_back(std::move(state));
    }
    if (!finite || both < std::min(times_at_once, ahead.size())) break;
  }
  truth.complete = truth.states.size() == times.size();
  settle_still_components(backend.motion(), seen, sizes, keep_going);
  truth.sizes = sizes.divisors();
  for (std::size_t i = 0; i < size; ++i)
    truth.relative_uncertainty = std::max(truth.relative_uncertainty, doubts[i] / truth.sizes[i]);
  truth.relative_uncertainty += rounding;
  return truth;
}

}  // namespace

Truth truth_by_series(const RunBackend& backend, const RunState& start, const std::vector<DoubleDouble>& digits,
                      const std::vector<double>& times, const KeepGoing& keep_going,
                      std::span<const std::size_t> kinds) {
  constexpr double closest = 1e-27, close = 1e-23, rounding = 0x1p-53;
  // With more operations, a step in double-double takes too long; with still more, even one in double.
  constexpr tape::Index most_in_quad = tape::most_of_equations / 4, most_in_double = 2 * tape::most_of_equations;
  Truth truth{{}, rounding, 0, {}, "quad precision run", false};
  tape::Tape tape;
  const std::vector<tape::Index> rates = backend.write_equations(tape);
  if (tape.size() > most_in_double) truth.missing = missing::too_long;
  if (!TrueMotion::covers(tape)) truth.missing = missing::no_series;
  if (!truth.missing.empty()) return truth;
  if (tape.size() > most_in_quad) {
    truth.how = "double precision run";
    TwoDoubleMotions both(taylor::program_of(tape, rates, rates.size()), digits, start.t);
    return truth_of(backend, start, times, keep_going, kinds, std::move(truth),
                    [&](std::span<const double> some) { return both.at(some, keep_going); });
  }
  TrueMotion fine(tape, rates, closest), coarse(std::move(tape), rates, close);
  fine.start(digits, start.t);
  coarse.start(digits, start.t);
  bool lost = false;
  truth = truth_of(backend, start, times, keep_going, kinds, std::move(truth), [&](std::span<const double> some) {
    SideBySide found = side_by_side(fine, coarse, some, keep_going);
    lost = found.lost;
    return std::move(found.states);
  });
  if (lost) truth.states.clear();  // another method may reach all times
  if (fine.stuck() || coarse.stuck()) truth.missing = missing::no_motion;
  return truth;
}

}  // namespace least
