#include "core/reference/growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/run/differences.hpp"
#include "core/run/landmarks.hpp"
#include "core/run/still_components.hpp"
#include "core/run/tangent_motion.hpp"
#include "core/tape/derivative.hpp"

namespace least {
namespace {

/// Returns a state from which steps can be taken: the end of the problem's series where the equations of motion are
/// singular at the start, else the start.
RunState after_series(const ProblemTable& problem, const RunState& start, double end) {
  const double until = problem.traits.series_until;
  return problem.starts_series(start) && end > until ? problem.series_state(until) : start;
}

/// Returns the number of steps between two looks at the clock: one for scenes with long equations.
std::size_t steps_between_looks(const RunBackend& backend) {
  constexpr tape::Index small = 512;  // operations, of which a step takes microseconds
  tape::Tape tape;
  backend.write_equations(tape);
  return tape.size() > small || tape.has_terms() ? 1 : 64;
}

/// keeps_volume tells whether a flow has no divergence, term by term: then nothing in it is damped.
bool keeps_volume(const RunBackend& backend) {
  if (!backend.motion().traits.flow) return false;
  try {
    tape::Tape tape;
    const auto rates = backend.write_equations(tape);
    std::size_t left = tape::most_of_equations;
    Symbol divergence(0);
    for (std::size_t i = 0; i < rates.size(); ++i)
      for (const auto& [place, slope] : tape::slopes_of(tape, Symbol::at(tape, rates[i]), static_cast<int>(i), 1, left))
        divergence = divergence + slope;
    return divergence.is_constant() && divergence.constant() == 0;
  } catch (const tape::TooManyOperations&) {
    return false;
  }
}

class GrowthOfDifferences {
  static constexpr std::size_t parts = Conditioning::parts;

 public:
  /// `kinds`: the kinds of the variables, kinds_of the card.
  GrowthOfDifferences(const RunBackend& backend, RunState start, double end, const KeepGoing& keep_going,
                      std::span<const std::size_t> kinds)
      : backend_(backend), problem_(backend.motion()), keep_going_(keep_going), kinds_(kinds), from_(start.t) {
    start = after_series(problem_, start, end);
    if (backend.found() > 0) {
      // Where differences grow much, the computed motion stays near the true one only with a close tolerance.
      follow(start, end, 1e-9);
      if (!found_.complete || found_.most_growth * 1e-9 < 1e-2) return;
      const Conditioning known = found_;
      follow(start, end, 1e-12);
      if (!found_.complete) found_ = known;
    } else {
      follow_series(start, end);
      if (!found_.ends || found_.leaves) return;
      // A kink of the force ends a series, but not the motion: steps without series get past it.
      constexpr double beyond = 0.01;
      const Conditioning known = found_;
      follow(start, end, 1e-9);
      if (!(found_.reached - from_ > (1 + beyond) * (known.reached - from_))) found_ = known;
    }
  }

  const Conditioning& found() const { return found_; }

 private:
  /// Limits of the number of steps, not of time, so that the answer does not depend on the machine.
  static constexpr std::size_t patience = 200'000, patience_of_series = 50'000;
  /// The most variables that a motion and its derivatives may have together if their equations are to be short enough
  /// for a series. With more, nothing is found out, and no memory is reserved.
  static constexpr std::size_t most_numbers = tape::most_of_equations;

  /// Follows all directions, one after the other. Where the motion ends early, follows them again up to shortly before.
  void follow(const RunState& start, double end, double tolerance) {
    begin(end, false, false);
    for (std::size_t direction = 0; direction < size_ && found_.reached > start.t;)
      direction = along(start, direction, tolerance) ? direction + 1 : 0;
    conclude();
  }
  /// Follows all directions at once, by series.
  void follow_series(const RunState& start, double end) {
    std::vector<std::size_t> directions;
    for (std::size_t i = 0; i < size_; ++i)
      if (backend_.has_component(i)) directions.push_back(i);
    if (size_ * (1 + directions.size()) > most_numbers) return know_nothing(end);
    begin(end, false, false);
    tape::Tape tape;
    const auto rates = backend_.write_equations(tape);
    tangents_.assign(directions.size() * size_, 0);
    for (std::size_t d = 0; d < directions.size(); ++d) tangents_[d * size_ + directions[d]] = 1;
    try {
      TangentMotion motion(std::move(tape), rates, directions.size(), 1e-14);  // digits cost a series little
      while (found_.reached > start.t && !along(start, motion, directions)) {
      }
    } catch (const tape::TooManyOperations&) {  // then nothing is found out
      found_.complete = false;
    }
    conclude();
  }
  void begin(double end, bool ends, bool leaves) {
    found_ = {};
    found_.variables = size_;
    found_.reached = end;
    found_.ends = ends;
    found_.leaves = leaves;
    found_.so_far.fill(1);
    found_.relative_so_far.fill(1);
    if (problem_.traits.constant_damping) found_.damping = problem_.damping(from_);
    if (problem_.traits.conservative || problem_.traits.keeps_energy || keeps_volume_) found_.damping = 0;
    sizes_ = ComponentSizes(kinds_, size_);
    derivatives_.assign(parts * size_ * size_, 0);
    at_end_.assign(size_ * size_, 0);
  }
  void know_nothing(double end) {
    found_ = {};
    found_.variables = size_;
    found_.reached = end;
    found_.so_far.fill(1);
    found_.relative_so_far.fill(1);
    found_.complete = false;
  }
  /// Computes what depends on the sizes of all components.
  void conclude() {
    std::vector<RunState> states;
    for (const auto& mark : landmarks_.list()) {
      found_.pace.push_back(mark.x.t);
      states.push_back(mark.x);
    }
    for (const auto& mark : scaled_landmarks_.list()) found_.relative_pace.push_back(mark.x.t);
    if (!states.empty()) settle_still_components(problem_, states, sizes_, keep_going_);
    found_.sizes = sizes_.divisors();
    const auto growth = [&](const double* derivatives) {
      double most = 1;
      for (std::size_t j = 0; j < size_; ++j)
        for (std::size_t i = 0; i < size_; ++i)
          if (sizes_.largest(i) > 0 && sizes_.largest(j) > 0)
            most = std::max(most, derivatives[j * size_ + i] * (sizes_.largest(j) / sizes_.largest(i)));
      return most;
    };
    found_.relative_growth = growth(at_end_.data());
    for (std::size_t k = 0; k < parts; ++k) {
      found_.relative_so_far[k] =
          std::max(growth(&derivatives_[k * size_ * size_]), k > 0 ? found_.relative_so_far[k - 1] : 1);
      found_.most_relative_growth = std::max(found_.most_relative_growth, found_.relative_so_far[k]);
    }
  }

  /// Follows one direction. Returns false if the motion ends before `reached`, which is then set back.
  bool along(const RunState& start, std::size_t direction, double tolerance) {
    if (!backend_.has_component(direction)) return true;
    Differences motion(backend_, start, direction, found_.reached, tolerance);
    const auto seen = [&] {
      see(motion.state(), motion.growth(), direction == 0);
      const StateNumbers& derivative = motion.derivative();
      see_derivatives(motion.time(), direction, [&](std::size_t i) { return derivative[i]; });
    };
    seen();
    for (std::size_t step = 1; motion.time() < found_.reached && found_.complete; ++step) {
      if (!motion.advance()) {
        if (!motion.lost()) return ends(motion.time(), motion.left_domain());
        found_.complete = false;
        break;
      }
      seen();
      found_.complete = step < patience && (step % between_looks_ != 0 || keep_going_());
    }
    found_.growth = std::max(found_.growth, motion.growth());
    return true;
  }
  /// Follows all directions at once. Steps of a series are long, so the motion is examined several times within each.
  bool along(const RunState& start, TangentMotion& motion, std::span<const std::size_t> directions) {
    constexpr int looks = 16;
    RunState x = start;
    motion.start({start.numbers.data(), size_}, tangents_, start.t);
    double absolute = 1;
    bool left_domain = false;
    const auto seen = [&](double t) {
      double largest = 1;
      for (std::size_t i = 0; i < size_; ++i) {
        x[i] = motion.state()[i];
        largest = std::max(largest, std::abs(x[i]));
      }
      x.t = t;
      left_domain = problem_.outside(x);
      if (left_domain) return false;
      absolute = motion.growth() / largest;
      see(x, absolute, true);
      for (std::size_t d = 0; d < directions.size(); ++d)
        see_derivatives(t, directions[d], [&](std::size_t i) { return motion.derivative(i, d); });
      return true;
    };
    seen(start.t);
    double most = std::numeric_limits<double>::infinity();  ///< bound of steps, at the edge of the domain
    double longest = 0;  ///< step so far: before the end of a motion, steps become negligible beside it
    for (std::size_t step = 1; motion.time() < found_.reached && found_.complete; ++step) {
      const double from = motion.time(), left = found_.reached - from, h = std::min({motion.step(), left, most});
      if (!(h > 1e-13 * std::max(std::abs(from), longest))) return ends(from, false);
      const auto time = [&](int part) { return part == looks && h == left ? found_.reached : from + h * part / looks; };
      int part = 0;
      left_domain = false;
      while (part < looks && motion.look(h * (part + 1) / looks) && seen(time(part + 1))) ++part;
      if (part < looks && part > 0) motion.look(h * part / looks);
      if (part == 0 || !motion.move(time(part))) {
        if (h < 1e-3 * left) return ends(from, left_domain);
        most = h / looks;
        continue;
      }
      most = std::numeric_limits<double>::infinity();
      longest = std::max(longest, h);
      found_.complete = step < patience_of_series && keep_going_();
    }
    found_.growth = std::max(found_.growth, absolute);
    return true;
  }
  bool ends(double t, bool leaves) {
    begin(from_ + 0.995 * (t - from_), true, leaves);
    return false;
  }

  /// Returns the eighth of the span in which a time lies.
  std::size_t part_at(double t) const {
    const double done = (t - from_) / (found_.reached - from_);
    return std::min(static_cast<std::size_t>(std::max(done * parts - 1e-9, 0.0)), parts - 1);
  }
  /// Records |∂x_i/∂x_j| of direction j at the time t; derivative(i) returns ∂x_i/∂x_j.
  template <class Derivative>
  void see_derivatives(double t, std::size_t j, Derivative&& derivative) {
    double* const largest = &derivatives_[(part_at(t) * size_ + j) * size_];
    for (std::size_t i = 0; i < size_; ++i) {
      const double here = std::abs(derivative(i));
      largest[i] = std::max(largest[i], here);
      at_end_[j * size_ + i] = here;
    }
  }
  /// Records the growth at the state x, and the state itself if this is the `first` of several passes along the motion.
  void see(const RunState& x, double growth, bool first) {
    for (std::size_t k = part_at(x.t); k < parts; ++k) found_.so_far[k] = std::max(found_.so_far[k], growth);
    found_.most_growth = std::max(found_.most_growth, growth);
    if (!first) return;
    sizes_.see(x);
    RunState scaled = x;  // relative to the sizes so far
    for (std::size_t i = 0; i < size_; ++i) scaled[i] = sizes_.largest(i) > 0 ? x[i] / sizes_.largest(i) : 0;
    x.t > from_ ? landmarks_.see(x) : landmarks_.start(x);
    x.t > from_ ? scaled_landmarks_.see(scaled) : scaled_landmarks_.start(scaled);
    for (std::size_t i = 0; i < size_; ++i) found_.size = std::max(found_.size, std::abs(x[i]));
    if (x.t - from_ <= 0.5 * (found_.reached - from_)) found_.size_halfway = found_.size;
    if (problem_.traits.keeps_energy) {
      const EnergyTerms terms = problem_.energy_terms(x);
      found_.energy = std::max(found_.energy, std::abs(terms.total));
      if (problem_.traits.potential) found_.energy = std::max(found_.energy, terms.total - terms.potential);
    }
    if (problem_.traits.has_frequency) {
      const double here = std::sqrt(problem_.frequency_squared(x));
      found_.slowest = std::fmin(found_.slowest, here);
      found_.fastest = std::fmax(found_.fastest, here);
    }
  }

  const RunBackend& backend_;
  const ProblemTable& problem_;
  const std::size_t size_ = problem_.traits.components;
  const bool keeps_volume_ = keeps_volume(backend_);
  const KeepGoing& keep_going_;
  const std::size_t between_looks_ = steps_between_looks(backend_);
  std::span<const std::size_t> kinds_;
  double from_;
  Landmarks landmarks_{48}, scaled_landmarks_{48};
  ComponentSizes sizes_{kinds_, size_};
  std::vector<double> tangents_;     ///< derivatives at the start, one direction after the other
  std::vector<double> derivatives_;  ///< largest |∂x_i/∂x_j| by eighth of the span, direction j and component i
  std::vector<double> at_end_;
  Conditioning found_;
};

}  // namespace

std::vector<PaceMark> pace_of(const RunBackend& backend, const RunState& start, double end,
                              const KeepGoing& keep_going) {
  std::vector<PaceMark> marks;
  const RunState first = after_series(backend.motion(), start, end);
  if (!(first.t < end)) return marks;
  Landmarks landmarks{64};
  landmarks.start(first);
  Differences motion(backend, first, 0, end, 1e-9);
  const std::size_t between_looks = steps_between_looks(backend);
  for (std::size_t step = 1; motion.time() < end && motion.advance(); ++step) {
    landmarks.see(motion.state());
    if (step % between_looks == 0 && !keep_going()) break;
  }
  for (const auto& [x, speed] : landmarks.list()) marks.push_back({x.t, speed});
  return marks;
}

Conditioning conditioning_of(const RunBackend& backend, const RunState& start, double end, const KeepGoing& keep_going,
                             std::span<const std::size_t> kinds) {
  return GrowthOfDifferences(backend, start, end, keep_going, kinds).found();
}

}  // namespace least
