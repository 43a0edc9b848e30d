#include "core/run/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/run/tangent_path.hpp"
#include "core/tape/derivative.hpp"

namespace least {
namespace {

/// may_be_sensitive returns whether differences may grow exponentially while the motion stays bounded: not if it is
/// known in closed form, nor for an autonomous motion in a plane.
bool may_be_sensitive(const RunBackend& backend, StateView start) {
  if (backend.has_closed_form(start)) return false;
  std::size_t components = 0;
  for (std::size_t i = 0; i < backend.motion().traits.components; ++i) components += backend.has_component(i);
  if (components > 2) return true;
  tape::Tape tape;
  const auto rates = backend.write_equations(tape);
  tape::Dependences depends(tape, [](int) { return tape::Dependence(0); });
  return std::ranges::any_of(rates, [&](tape::Index rate) { return depends(Symbol::at(tape, rate)) != 0; });
}

/// GrowthSoFar records how far differences have grown, step by step, and judges it as `Conditioning` does.
class GrowthSoFar {
 public:
  void see(double t, double growth) {
    most_ = std::max(most_, growth);
    seen_.emplace_back(t, most_);
  }
  double most() const { return most_; }
  /// Whether they have grown exponentially all along the time since `from`.
  bool exponential(double from) const {
    if (seen_.empty()) return false;
    Conditioning known;
    known.so_far.fill(1);
    for (const auto& [t, growth] : seen_) {
      const double done = (t - from) / (seen_.back().first - from);
      for (std::size_t k = 0; k < Conditioning::parts; ++k)
        if (done * Conditioning::parts <= double(k + 1)) known.so_far[k] = std::max(known.so_far[k], growth);
    }
    return known.chaotic();
  }

 private:
  double most_ = 1;
  std::vector<std::pair<double, double>> seen_;
};

}  // namespace

std::optional<Sensitivity> sensitivity(const RunBackend& backend, RunState x, std::span<const RunState> states,
                                       Norm norm, std::span<const double> sizes, double large, double own_noise,
                                       std::int64_t most_operations, const KeepGoing& keep_going) {
  const ProblemTable& problem = backend.motion();
  const std::size_t count = problem.traits.components;
  if (problem.starts_series(x)) x = problem.series_state(problem.traits.series_until);
  while (!states.empty() && !(states.front().t > x.t)) states = states.subspan(1);
  const auto rests = [&](const RunState& state) { return state_error(state, x, count) == 0; };
  if (std::ranges::all_of(states, rests) || !may_be_sensitive(backend, x)) return std::nullopt;
  const auto size_of = [&](const auto& components) {
    double most = 0;
    for (std::size_t i = 0; i < count; ++i) most = std::max(most, std::abs(components[i]));
    return most;
  };
  const double start = x.t, end = states.back().t;
  double size = size_of(x);
  TangentPath path(backend, 1e-15, size);
  if (path.motion().linear()) return std::nullopt;
  StateNumbers u(count, 0.0);
  double known = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (backend.has_component(i)) u[i] = 1 / std::sqrt(++known);
  path.start(x, u.data());

  // `surely`: the true motion has to be more accurate than the error that it judges by this factor.
  constexpr double rounding = 0x1p-53, surely = 100;
  constexpr double beyond = 1.3, kept = 1e-3;  // growth that ends soon, as in a close passage, does not count
  constexpr double by_itself = 30;             // with less growth an error of the run is due to its steps
  GrowthSoFar growths;
  std::optional<double> lost, drowned;  // when the digits of the run are lost; and those of any run in double precision
  double drowned_growth = 0, noise = 0, growth = 1;
  const auto measure = [&] {
    const RunState here = path.state();
    const double now = size_of(here);
    size = std::max(size, now);
    const double part = norm == Norm::absolute ? std::max(1.0, now) : now;
    growth = std::ldexp(size_of(path.tangent()), path.exponent()) * size / part;
    noise = rounding * growth;
  };
  std::size_t next = 0;
  std::int64_t operations = 0;
  bool goes_on = true;
  while (goes_on && path.time() < end && operations < most_operations && keep_going()) {
    for (; next < states.size() && states[next].t <= path.reach(); ++next) {
      if (lost || drowned || !path.look(states[next].t)) continue;
      measure();
      const bool off = !(state_error(states[next], path.state(), count, sizes) <= large);
      if (off && surely * noise < large && growth > by_itself) lost = states[next].t;
    }
    goes_on = path.leap(end);
    operations += path.motion().operations();
    measure();
    growths.see(path.time(), growth);
    if (!drowned && !(noise <= large)) {
      drowned = path.time();
      drowned_growth = growth;
    }
    if (drowned && path.time() - start > beyond * (*drowned - start)) break;
  }
  const double time = path.time() - start, rate = std::log(growths.most()) / time;
  if (drowned && growth > kept * drowned_growth) return Sensitivity{lost ? std::min(*lost, *drowned) : *drowned, rate};
  if (drowned || !growths.exponential(start)) return std::nullopt;
  if (lost) return Sensitivity{*lost, rate};
  const double foreseen = start + std::log(large / (std::max(own_noise, rounding) * std::max(size, 1.0))) / rate;
  if (goes_on && path.time() < end && foreseen < end) return Sensitivity{foreseen, rate};
  return std::nullopt;
}

}  // namespace least
