#include "core/run/standstill.hpp"

#include <array>
#include <cmath>
#include <optional>

#include "core/number/asked_by_thread.hpp"
#include "core/run/control_stepper.hpp"

namespace least {
namespace {

/// largest_rate returns the largest |ẋ_i| at a state; NaN if one is NaN.
double largest_rate(const RunBackend& backend, StateView x) {
  StateNumbers rates(backend.motion().traits.components);
  backend.motion().rates(x, rates.data());
  double most = 0;
  for (const double rate : rates)
    if (const double size = std::abs(rate); !(size <= most)) most = size;
  return most;
}

/// Approach takes control runs towards a point where the motion ends.
class Approach {
 public:
  /// End is where a walk ended: its time, and whether no step leads further.
  struct End {
    double t;
    bool stands;
  };

  /// `most_forces` bounds the evaluations of each walk; keep_going() is asked now and then.
  Approach(const RunBackend& backend, const RunState& start, std::int64_t most_forces, const KeepGoing& keep_going)
      : backend_(backend), start_(start), most_forces_(most_forces), keep_going_(keep_going) {}

  /// walk goes from the start to `until`, or as far as steps lead; it calls see(state) after each step.
  template <class See>
  End walk(double tolerance, double until, See&& see) const {
    auto x = start_;
    ControlStepper stepper(backend_, tolerance);
    StandstillWatch watch(start_.t, 0);
    for (int step = 1; x.t < until; ++step) {
      const double before = x.t;
      if (stepper.work().forces > most_forces_ || (step % 256 == 0 && !keep_going_())) break;
      if (stepper.step(x) != StepStatus::ok || watch.see(before, x.t - before)) return {x.t, true};
      if (backend_.motion().outside(x)) break;
      see(x);
    }
    return {x.t, false};
  }

  /// sharpens returns whether the rates change on each scale of time on the way to `end`, as powers of the remaining
  /// time do. A walk stops on each scale; if rates were smooth at the end, they would change less on each smaller one,
  /// and steps would be short for another reason.
  bool sharpens(double tolerance, double end) const {
    constexpr int scales = 5;
    constexpr double first = 1e-2, least_change = 0.02, noise = 1e-12;
    const double span = end - start_.t;
    // The rates after the first step that ends within first·10⁻ᵏ of the end.
    std::array<std::optional<StateNumbers>, scales> at;
    walk(tolerance, end, [&](const RunState& x) {
      const double left = (end - x.t) / span;
      if (!(left > 0 && left < first)) return;
      const int scale = static_cast<int>(std::floor(std::log10(first / left)));
      if (scale < scales && !at[static_cast<std::size_t>(scale)])
        backend_.motion().rates(x, at[static_cast<std::size_t>(scale)].emplace(x.size()).data());
    });
    int changes = 0;
    std::optional<StateNumbers> last;
    for (const auto& rates : at) {
      if (!rates) continue;  // a step may skip a scale
      if (last) {
        double most = 0, largest = 0;
        for (std::size_t i = 0; i < start_.size(); ++i)
          largest = std::max({largest, std::abs((*last)[i]), std::abs((*rates)[i])});
        for (std::size_t i = 0; i < start_.size(); ++i)
          if (const double size = std::max(std::abs((*last)[i]), std::abs((*rates)[i])); size > noise * largest)
            most = std::max(most, std::abs((*rates)[i] - (*last)[i]) / size);
        if (!(most > least_change)) return false;
        ++changes;
      }
      last = rates;
    }
    return changes >= 3;
  }

 private:
  const RunBackend& backend_;
  RunState start_;
  std::int64_t most_forces_;
  const KeepGoing& keep_going_;
};

}  // namespace

bool goes_on(const RunBackend& backend, RunState x, double duration) {
  constexpr int patience = 10'000, longest_look = 4 * patience, between_looks = 256;
  constexpr double closely = 1e-14, growth = 3, shrinkage = 1e-2, recovery = 10;
  ControlStepper stepper(backend, closely);
  const double end = x.t + duration, before = largest_rate(backend, x);
  double most = before, longest = 0, shortest = 0;  // `shortest`: since the longest step
  for (int step = 0; x.t < end; ++step) {
    if (step % between_looks == 0 && !AskedByThread::goes_on()) return true;
    const double t = x.t;
    if (stepper.step(x) != StepStatus::ok) return false;
    const double h = x.t - t, rate = largest_rate(backend, x);
    most = std::max(most, rate);
    shortest = h > longest ? h : std::min(shortest, h);
    longest = std::max(longest, h);
    const bool grew = most > growth * before;
    // The motion has come out of a fast passage, as of a body near its sun, so there was no singularity.
    if (grew && h > recovery * shortest && rate * growth < most) return true;
    if (step >= patience && !(grew && h < shrinkage * longest)) return true;
    if (step == longest_look) return false;
  }
  return true;
}

double singular_time(const RunBackend& backend, const Request& request, StepStatus status, double now, double step,
                     std::int64_t forces, const KeepGoing& keep_going) {
  constexpr double close = 1e-12, near = 1e-5, few_steps = 10, stretch = 0.1;
  constexpr std::int64_t few = 20'000, many = 200'000;
  if (request.probe || status == StepStatus::solver_failed) return unknown;
  const Scene& scene = *request.scene;
  const ProblemTable& problem = backend.motion();
  RunState start = problem.start(scene.initial, scene.start);
  const double way = stretch * (now - start.t), earliest = now - std::max(way, few_steps * step),
               latest = now + (step > 0 ? few_steps * step : way);
  if (problem.starts_series(start)) start = problem.series_state(problem.traits.series_until);
  if (!(start.t < latest)) return unknown;
  const std::int64_t most = std::clamp<std::int64_t>(10 * forces, few, many) / weight_of_force(*scene.mechanics);
  const Approach approach(backend, start, most, keep_going);
  const auto unseen = [](const RunState&) {};
  const auto one = approach.walk(100 * close, latest, unseen), other = approach.walk(close, latest, unseen);
  const auto agree = [&](double a, double b) { return std::abs(a - b) < near * (b - start.t); };
  double known = unknown;
  if (other.stands && (one.stands ? agree(one.t, other.t) : step == 0 && agree(now, other.t)))
    known = other.t;
  else if (!other.stands && one.stands && step == 0 && agree(one.t, now))
    known = now;
  if (!(known >= earliest && known <= latest)) return unknown;
  if (!approach.sharpens(close, known)) return unknown;
  return step == 0 && agree(known, now) ? std::max(known, now) : known;
}

}  // namespace least
