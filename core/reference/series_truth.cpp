#include "core/reference/series_truth.hpp"

#include <algorithm>
#include <cmath>

#include "core/reference/true_motion.hpp"
#include "core/run/still_components.hpp"

namespace least {

Truth truth_by_series(const RunBackend& backend, const RunState& start, const std::vector<double>& times,
                      const KeepGoing& keep_going, std::span<const std::size_t> kinds) {
  constexpr double closest = 1e-27, close = 1e-23, rounding = 0x1p-53;
  constexpr std::size_t at_once = 256;
  Truth truth{{}, rounding, 0, {}, "quad precision run", false};
  const std::size_t size = start.size();
  tape::Tape tape;
  const std::vector<tape::Index> rates = backend.write_equations(tape);
  // Of larger ones a step in so many digits takes longer than anybody waits for a look at the clock.
  if (tape.size() > tape::most_of_equations / 4 || !TrueMotion::covers(tape)) return truth;
  TrueMotion fine(tape, rates, closest), coarse(std::move(tape), rates, close);
  const std::vector<DoubleDouble> digits(start.numbers.begin(), start.numbers.end());
  fine.start(digits, start.t);
  coarse.start(digits, start.t);

  ComponentSizes sizes(kinds, size);
  sizes.see(start);
  std::vector<RunState> seen{start};
  std::vector<double> doubts(size, 0);
  while (truth.states.size() < times.size()) {
    const auto ahead = std::span(times).subspan(truth.states.size());
    const auto [x, y] = side_by_side(fine, coarse, ahead.first(std::min(at_once, ahead.size())), keep_going);
    const std::size_t both = std::min(x.size(), y.size()) / size;
    bool finite = both > 0;
    for (std::size_t k = 0; k < both && finite; ++k) {
      const DoubleDouble *const here = &x[k * size], *const other = &y[k * size];
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
    if (!finite || both < std::min(at_once, ahead.size())) break;
  }
  truth.complete = truth.states.size() == times.size();
  settle_still_components(backend.motion(), seen, sizes, keep_going);
  truth.sizes = sizes.divisors();
  for (std::size_t i = 0; i < size; ++i)
    truth.relative_uncertainty = std::max(truth.relative_uncertainty, doubts[i] / truth.sizes[i]);
  truth.relative_uncertainty += rounding;
  return truth;
}

}  // namespace least
