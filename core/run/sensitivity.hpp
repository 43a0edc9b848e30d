// Until when the digits of a run mean something. Where the motion is chaotic, a difference of the last digit grows by
// e^{λt} until it is as large as the motion; what a run says beyond is noise, however small its tolerance. The true
// motion is followed from the start with a tangent to it, as far as a bounded number of operations goes, and held
// against states of the run.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/tangent_path.hpp"
#include "core/state_error.hpp"
#include "core/tape/derivative.hpp"

namespace least {

struct Sensitivity {
  double until;  ///< the time beyond which no digit is right
  double rate;   ///< λ, about
};

/// Whether differences may grow exponentially on a motion that stays bounded: not on one with a closed form, nor in a
/// plane that no time changes.
template <class P>
bool may_be_sensitive(const P& problem, const StateOf<P>& start) {
  if constexpr (HasExact<P>) {
    if constexpr (requires { problem.exact_applies(start); }) {
      if (problem.exact_applies(start)) return false;
    } else {
      return false;
    }
  }
  std::size_t components = 0;
  for (std::size_t i = 0; i < StateOf<P>::size; ++i) components += has_component(problem, i);
  if (components > 2) return true;
  tape::Tape tape;
  const auto rates = taylor::write_equations<StateOf<P>>(problem, tape);
  return std::ranges::any_of(
      rates, [&](tape::Index rate) { return (tape::dependence(tape, Symbol::at(tape, rate)) & tape::on_time) != 0; });
}

/// How far differences have grown, step by step, as `Conditioning` judges it.
class GrowthSoFar {
 public:
  void see(double t, double growth) {
    most_ = std::max(most_, growth);
    seen_.emplace_back(t, most_);
  }
  double most() const { return most_; }
  /// Exponentially all along the time since `from`.
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

/// Of a run from x that came to these states, whose times increase. `large`: the error from which none of their digits
/// is right; `sizes`: what such an error is divided by, as state_error has it. Nothing where the last one still has
/// right digits, as far as `most_operations` can tell.
template <class P>
std::optional<Sensitivity> sensitivity(const P& problem, StateOf<P> x, std::span<const StateOf<P>> states, Norm norm,
                                       std::span<const double> sizes, double large, std::int64_t most_operations,
                                       const std::atomic<bool>& cancelled) {
  using X = StateOf<P>;
  if constexpr (HasSeries<P>)
    if (starts_series(problem, x)) x = series_state<X>(problem, P::series_until);
  while (!states.empty() && !(states.front().t > x.t)) states = states.subspan(1);
  const auto rests = [&](const X& state) { return state_error(state, x) == 0; };
  if (std::ranges::all_of(states, rests) || !may_be_sensitive(problem, x)) return std::nullopt;
  const auto size_of = [](const auto& components) {
    double most = 0;
    for (std::size_t i = 0; i < X::size; ++i) most = std::max(most, std::abs(components[i]));
    return most;
  };
  const double start = x.t, end = states.back().t;
  double size = size_of(x);
  TangentPath<P> path(problem, 1e-15, size);
  if (path.motion().linear()) return std::nullopt;
  Vec<X::size> u{};
  double count = 0;
  for (std::size_t i = 0; i < X::size; ++i)
    if (has_component(problem, i)) u[i] = 1 / std::sqrt(++count);
  path.start(problem, x, u);

  constexpr double rounding = 0x1p-53, surely = 100;  // by how much less the true motion is off than what it judges
  constexpr double beyond = 1.3, kept = 1e-3;         // a growth that is over soon, as of a passage, is none
  constexpr double by_itself = 30;  // growth below which a run is off by its steps, whatever the motion
  GrowthSoFar growths;
  std::optional<double> lost, drowned;  // when the run's digits are gone; and those of any in double precision
  double drowned_growth = 0, noise = 0, growth = 1;
  const auto measure = [&] {
    const X here = path.state();
    const double now = size_of(here);
    size = std::max(size, now);
    const double part = norm == Norm::absolute ? std::max(1.0, now) : now;
    growth = std::ldexp(size_of(path.tangent()), path.exponent()) * size / part;
    noise = rounding * growth;
  };
  std::size_t next = 0;
  std::int64_t operations = 0;
  bool goes_on = true;
  while (goes_on && path.time() < end && operations < most_operations && !cancelled.load(std::memory_order_relaxed)) {
    for (; next < states.size() && states[next].t <= path.reach(); ++next) {
      if (lost || drowned || !path.look(states[next].t)) continue;
      measure();
      const bool off = !(state_error(states[next], path.state(), sizes) <= large);
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
  const double foreseen = start + std::log(large / (rounding * std::max(size, 1.0))) / rate;
  if (goes_on && path.time() < end && foreseen < end) return Sensitivity{foreseen, rate};
  return std::nullopt;
}

}  // namespace least
