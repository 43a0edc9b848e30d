// Reference solutions: the closed form where a problem has one, else the problem's own equations of motion integrated
// at two tolerances, whose difference is the uncertainty: by Taylor series in double-double, where the equations have
// them, else in quad by extrapolation, which takes several times as long.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "core/extrapolation.hpp"
#include "core/number/quad.hpp"
#include "core/problem_traits.hpp"
#include "core/reference/true_motion.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/problem_entries.hpp"
#include "core/run/steep_steps.hpp"
#include "core/run/still_components.hpp"
#include "core/schemes/taylor.hpp"
#include "core/state_error.hpp"

namespace least {

template <class P>
struct Reference {
  std::vector<StateOf<P>> states;  ///< at the times asked for, rounded to double
  double uncertainty = 0x1p-53;    ///< as a state_error in the absolute norm
  Vec<StateOf<P>::size> doubts{};  ///< by component: the largest difference between the two runs
  std::string_view how = "closed form";
  bool complete = true;        ///< false: it was told to give up, or the solution ceased to be finite
  std::string_view missing{};  ///< as in Truth
};

/// Returns the closed form at these times; a state that is not finite is the last one.
template <HasExact P>
Reference<P> closed_form(const P& problem, const StateOf<P>& x0, const std::vector<double>& times) {
  Reference<P> result;
  result.states.reserve(times.size());
  const auto start = convert<Quad, Quad>(x0);
  for (const double t : times) {
    result.states.push_back(convert<double, double>(problem.exact(start, Quad(t))));
    if (!std::isfinite(state_error(result.states.back(), x0))) {
      result.complete = false;
      break;
    }
  }
  return result;
}

inline constexpr double fine_tolerance = 1e-27, coarse_tolerance = 1e-23;

/// TwoRuns collects the states of the finer of two runs in quad precision, and how far the coarser one is from them.
template <class P>
class TwoRuns {
 public:
  TwoRuns() { result_.how = "quad precision run"; }
  /// Adds the state at t: fine(i) is component i of the finer run as a double, difference(i) is the coarser run minus
  /// the finer. Returns false where the state is not finite; the runs end there.
  template <class Fine, class Difference>
  bool add(double t, Fine&& fine, Difference&& difference) {
    StateOf<P> truth, other;
    truth.t = other.t = t;
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) {
      const double apart = difference(i);  // taken in quad, where it is not rounded away
      truth[i] = fine(i);
      other[i] = truth[i] + apart;
      result_.doubts[i] = std::max(result_.doubts[i], std::abs(apart));
    }
    if (!std::isfinite(state_error(other, truth))) return result_.complete = false;
    result_.uncertainty = std::max(result_.uncertainty, 0x1p-53 + state_error(other, truth));
    result_.states.push_back(truth);
    return true;
  }
  void give_up(std::string_view missing = {}) {
    result_.complete = false;
    result_.missing = missing;
  }
  Reference<P> result() && { return std::move(result_); }

 private:
  Reference<P> result_;
};

/// Runs the two tolerances by extrapolation in quad. keep_going() returns false to give up.
template <class P, class KeepGoing>
Reference<P> extrapolated_run(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                              KeepGoing&& keep_going) {
  constexpr double closely = 1e-12;
  TwoRuns<P> runs;
  const auto start = convert<Quad, Quad>(x0);
  Extrapolation<P> fine(problem, start, fine_tolerance), coarse(problem, start, coarse_tolerance);
  const SteepSteps steep = steep_steps(problem);
  const auto part = [&steep](const auto& from, const auto& to) {
    return steep.resolved_part(run_state(convert<double, double>(from)), run_state(convert<double, double>(to)),
                               closely);
  };
  if (!steep.empty()) {
    fine.bound_steps(part);
    coarse.bound_steps(part);
  }
  for (const double t : times) {
    if (!fine.advance(Quad(t), keep_going) || !coarse.advance(Quad(t), keep_going)) {
      runs.give_up();
      break;
    }
    const auto state = [&](std::size_t i) { return static_cast<double>(fine.state()[i]); };
    const auto difference = [&](std::size_t i) { return static_cast<double>(coarse.state()[i] - fine.state()[i]); };
    if (!runs.add(t, state, difference)) break;
  }
  return std::move(runs).result();
}

/// Rounds quads to double-doubles.
inline std::vector<DoubleDouble> digits_of(std::span<const Quad> numbers) {
  std::vector<DoubleDouble> digits;
  for (const Quad& number : numbers) {
    const auto high = static_cast<double>(number);
    digits.emplace_back(high, static_cast<double>(number - Quad(high)));
  }
  return digits;
}

/// Runs the two tolerances by Taylor series of the equations on the tape, whose rates are the nodes `rates`. Returns
/// nothing where the motion comes to a place without a series.
template <class P, class KeepGoing>
std::optional<Reference<P>> series_run(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                       tape::Tape tape, std::span<const tape::Index> rates, KeepGoing&& keep_going) {
  TwoRuns<P> runs;
  TrueMotion fine(tape, rates, fine_tolerance), coarse(std::move(tape), rates, coarse_tolerance);
  const auto start = [&](const std::vector<DoubleDouble>& x, double t) {
    fine.start(x, t);
    coarse.start(x, t);
  };
  if (!starts_series(problem, x0)) {
    start(digits_of(taylor::values_of(convert<Quad, Quad>(x0))), x0.t);
  } else if constexpr (HasSeries<P>) {
    start(digits_of(taylor::values_of(series_state<StateOf<P, Quad, Quad>>(problem, P::series_until))),
          P::series_until);
  }
  std::size_t done = 0;
  if constexpr (HasSeries<P>)
    if (starts_series(problem, x0))
      for (; done < times.size() && times[done] <= P::series_until; ++done) {  // where equations may be singular
        const auto x = series_state<StateOf<P, Quad, Quad>>(problem, times[done]);
        runs.add(
            times[done], [&](std::size_t i) { return static_cast<double>(x[i]); }, [](std::size_t) { return 0.0; });
      }
  constexpr std::size_t at_once = 4096, components = StateOf<P>::size;
  bool told = false;
  const auto going = [&] { return !(told = told || !keep_going()); };
  for (bool good = true; good && done < times.size();) {
    const auto ahead = std::span(times).subspan(done, std::min(at_once, times.size() - done));
    const SideBySide found = side_by_side(fine, coarse, ahead, going);
    if (!told && found.lost) return std::nullopt;
    const auto& [x, y] = found.states;
    const std::size_t both = std::min(x.size(), y.size()) / components;
    for (std::size_t n = 0; good && n < both; ++n, ++done) {
      const DoubleDouble *const fine_x = x.data() + n * components, *const coarse_x = y.data() + n * components;
      const auto state = [=](std::size_t i) { return fine_x[i].high(); };
      good = runs.add(times[done], state, [=](std::size_t i) { return (coarse_x[i] - fine_x[i]).high(); });
    }
    if (both < ahead.size()) {
      runs.give_up(!told && (fine.stuck() || coarse.stuck()) ? missing::no_motion : std::string_view());
      break;
    }
  }
  return std::move(runs).result();
}

/// Runs the two tolerances by Taylor series where the equations have them, else by extrapolation.
template <class P, class KeepGoing>
Reference<P> quad_precision_run(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  tape::Tape tape;
  const auto rates = taylor::write_equations<StateOf<P>>(problem, tape);
  // With larger equations, a step in so many digits would take too long between two looks at the clock.
  constexpr tape::Index most_operations = tape::most_of_equations / 4;
  if (tape.size() > most_operations) {
    Reference<P> none;
    none.complete = false;
    none.missing = missing::too_long;
    return none;
  }
  if (TrueMotion::covers(tape))
    if (auto run = series_run(problem, x0, times, std::move(tape), rates, keep_going)) return *std::move(run);
  return extrapolated_run(problem, x0, times, keep_going);
}

/// Whether the problem has a closed form for this start.
template <class P>
bool has_closed_form(const P& problem, const StateOf<P>& x0) {
  if constexpr (requires { problem.exact_applies(x0); }) return problem.exact_applies(x0);
  return HasExact<P>;
}

/// Returns the true states at increasing times from x0 on. A run asks keep_going() now and then and gives up if it
/// returns false; a closed form, which takes no time, does not ask.
template <class P, class KeepGoing>
Reference<P> reference_solution(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  if constexpr (HasExact<P>)
    if (has_closed_form(problem, x0)) return closed_form(problem, x0, times);
  return quad_precision_run(problem, x0, times, keep_going);
}

/// Returns the reference solution as a Truth, which is independent of the type of the problem. `kinds`: the kinds of
/// the variables, kinds_of the card.
template <class P>
Truth true_states(const P& problem, const StateOf<P>& x0, const std::vector<double>& times, const KeepGoing& keep_going,
                  std::span<const std::size_t> kinds) {
  auto reference = reference_solution(problem, x0, times, keep_going);
  Truth truth{{}, reference.uncertainty, 0, {}, reference.how, reference.complete, reference.missing};
  ComponentSizes sizes(kinds, StateOf<P>::size);
  sizes.see(x0);
  for (const auto& x : reference.states) {
    auto& state = truth.states.emplace_back();
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) state.push_back(x[i]);
    sizes.see(x);
  }
  std::vector<RunState> seen{run_state(x0)};
  for (const auto& x : reference.states) seen.push_back(run_state(x));
  settle_still_components(ProblemEntries<P, StateOf<P>>(problem), seen, sizes, keep_going);
  truth.sizes = sizes.divisors();
  for (std::size_t i = 0; i < StateOf<P>::size; ++i)
    truth.relative_uncertainty = std::max(truth.relative_uncertainty, reference.doubts[i] / truth.sizes[i]);
  truth.relative_uncertainty += 0x1p-53;
  return truth;
}

}  // namespace least
