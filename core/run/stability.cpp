#include "core/run/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "core/from_values.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/harmonic_oscillator.hpp"
#include "core/schemes/list.hpp"
#include "core/schemes/text_list.hpp"

namespace least {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// StepMap holds the trace and the determinant of a step's matrix; not finite if the step fails.
struct StepMap {
  double trace = infinite, determinant = infinite;

  /// The conditions of Schur and Cohn for eigenvalues within the unit circle, none negative if stable: at 1, at −1, and
  /// complex.
  std::array<double, 3> margins() const { return {1 + determinant - trace, 1 + determinant + trace, 1 - determinant}; }
  bool stable() const {
    constexpr double accuracy = 1e-11;
    const auto all = margins();
    return std::ranges::all_of(all, [](double x) { return x >= -accuracy && std::isfinite(x); });
  }
  double radius() const {
    const double half = trace / 2, root = half * half - determinant;  // eigenvalues half ± √root
    return std::isfinite(root) ? root > 0 ? std::abs(half) + std::sqrt(root) : std::sqrt(determinant) : infinite;
  }
};

/// unit_step returns the map of a step of length 1 of a scheme whose parameter `step` is 1.
template <class Scheme, class P>
StepMap unit_step(const Scheme& scheme, const P& oscillator) {
  double m[2][2];
  for (int k = 0; k < 2; ++k) {
    State<1> x{0, {k == 0 ? 1.0 : 0.0}, {k == 1 ? 1.0 : 0.0}, {}};
    StepStatus status;
    if constexpr (SelfTimed<Scheme>) {
      status = scheme.bind(oscillator, x, energy(oscillator, x)).step(x);
    } else {
      status = scheme.bind(oscillator, x).step(x, 1);
    }
    if (status != StepStatus::ok) return {};
    m[0][k] = x.q[0];
    m[1][k] = x.p[0];
  }
  return {m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]};
}

/// steps_in_time: steps have a length in time, and so possibly a longest stable one.
template <class Scheme>
constexpr bool steps_in_time = !SelfTimed<Scheme> || requires(const Scheme& scheme) {
  scheme.in_time();
};
/// moves_oscillators: the scheme takes steps of oscillators, damped or not. For other schemes no bound is known.
template <class Scheme>
constexpr bool moves_oscillators = FixedStepSchemeFor<Scheme, problems::HarmonicOscillator<>> ||
                                   SelfTimedSchemeFor<Scheme, problems::HarmonicOscillator<>> ||
                                   FixedStepSchemeFor<Scheme, problems::DampedOscillator<>>;

/// step_map returns the map of a step at z and a; the identity for a scheme without a bound, whose steps are not steps
/// of time.
template <class Scheme>
StepMap step_map(std::span<const double> settings, double z, double a) {
  auto scheme = from_values<Scheme>(Scheme::fields, settings);
  if constexpr (requires { scheme.step; }) scheme.step = 1;
  if constexpr (requires { scheme.in_time(); }) {
    scheme = scheme.in_time();
  } else if constexpr (!steps_in_time<Scheme> || !moves_oscillators<Scheme>) {
    return {2, 1};
  }
  if constexpr (FixedStepSchemeFor<Scheme, problems::HarmonicOscillator<>> ||
                SelfTimedSchemeFor<Scheme, problems::HarmonicOscillator<>>) {
    if (a == 0) return unit_step(scheme, problems::HarmonicOscillator<>{1, z * z});
  }
  if constexpr (FixedStepSchemeFor<Scheme, problems::DampedOscillator<>>) {
    return unit_step(scheme, problems::DampedOscillator<>{z * z, a});
  } else {
    return {};
  }
}

/// step_setting returns the index of the setting `step`, with which z and a scale; beyond the last one if there is
/// none.
template <class Scheme>
constexpr std::size_t step_setting() {
  std::size_t i = 0;
  std::apply([&](const auto&... field) { (void)((field.name == "step" || (++i, false)) || ...); }, Scheme::fields);
  return i;
}

template <class Scheme>
double flip(std::span<const double> settings) {
  const auto scheme = from_values<Scheme>(Scheme::fields, settings);
  if constexpr (requires { scheme.flips_from(); }) return scheme.flips_from();
  return infinite;
}

struct Entry {
  StepMap (*map)(std::span<const double>, double, double);
  double (*flip)(std::span<const double>);
  std::size_t step;
  bool steps_in_time;  ///< otherwise there is no bound
};
template <class... Scheme>
constexpr std::array<Entry, sizeof...(Scheme)> entries(std::tuple<Scheme...>*) {
  return {Entry{&step_map<Scheme>, &flip<Scheme>, step_setting<Scheme>(),
                steps_in_time<Scheme> && moves_oscillators<Scheme>}...};
}
/// For schemes of scenes given as text no bound is known.
template <class... Scheme>
constexpr std::array<Entry, sizeof...(Scheme)> entries_without_bounds(std::tuple<Scheme...>*) {
  return {Entry{[](std::span<const double>, double, double) {
                  return StepMap{2, 1};
                },
                [](std::span<const double>) { return infinite; }, step_setting<Scheme>(), false}...};
}
constexpr auto scheme_entries = [] {
  constexpr auto known = entries(static_cast<SchemeList*>(nullptr));
  constexpr auto more = entries_without_bounds(static_cast<TextSchemeList*>(nullptr));
  std::array<Entry, known.size() + more.size()> all{};
  std::ranges::copy(more, std::ranges::copy(known, all.begin()).out);
  return all;
}();

/// Line searches the stable steps along the line z·u, a0 + a·u.
class Line {
 public:
  Line(std::size_t scheme, std::span<const double> settings, double z, double a0, double a)
      : map_(scheme_entries[scheme].map), settings_(settings), z_(z), a0_(a0), a_(a) {}

  /// The stable intervals of u up to `most`. One that reaches `most` extends to infinity.
  std::vector<Interval> stable(double most) const {
    std::vector<Interval> found;
    // Without damping, growth by a power of the step is only visible at a step that is not too small.
    double u = damped() ? 1e-6 : spacing(0);
    std::array<Look, 3> last{};  // newest first
    bool open = false;           // whether the last interval is still open
    for (int k = 0; last[0].u < most; ++k) {
      last = {Look{u, map_at(u)}, last[0], last[1]};
      if (k > 1 && open)
        if (const auto gap = gap_between(last)) {
          found.back().high = border(last[2].u, *gap);
          found.push_back({border(last[0].u, *gap), infinite});
        }
      if (k > 1)
        if (const auto island = island_between(last)) found.push_back(*island);
      const bool holds = last[0].map.stable();
      if (holds && !open) found.push_back({k == 0 ? 0 : border(u, last[1].u), infinite});
      if (!holds && open) found.back().high = border(last[1].u, u);
      open = holds;
      u += damped() && u < spacing(0) ? u : spacing(u);
    }
    return found;
  }

 private:
  struct Look {
    double u = 0;
    StepMap map;
  };
  bool damped() const { return a0_ > 0 || a_ > 0; }
  static double spacing(double u) { return std::max(0.01, u / 400); }
  StepMap map_at(double u) const { return map_(settings_, z_ * u, a0_ + a_ * u); }

  /// border returns the stable end of a bracket between a stable and an unstable u.
  double border(double stable, double failing) const {
    while (std::abs(failing - stable) > 1e-9 * std::abs(stable)) {
      const double middle = (stable + failing) / 2;
      if (middle == stable || middle == failing) break;
      (map_at(middle).stable() ? stable : failing) = middle;
    }
    return stable;
  }
  /// gap_between returns an unstable u between three stable ones: it searches the minimum of a margin that comes near 0
  /// between them.
  std::optional<double> gap_between(const std::array<Look, 3>& last) const {
    for (const Look& look : last)
      if (!look.map.stable()) return std::nullopt;
    // Without damping the determinant is 1 to round-off everywhere, or nowhere.
    const std::size_t margins = damped() ? 3 : 2;
    for (std::size_t i = 0; i < margins; ++i) {
      const double left = last[2].map.margins()[i], here = last[1].map.margins()[i], right = last[0].map.margins()[i];
      if (!(here <= left && here < right && here < left + right - 2 * here)) continue;
      double low = last[2].u, high = last[0].u;
      while (high - low > 1e-9 * high) {
        const double u = low + (high - low) / 3, v = high - (high - low) / 3;
        const StepMap at_u = map_at(u), at_v = map_at(v);
        if (!at_u.stable()) return u;
        if (!at_v.stable()) return v;
        (at_u.margins()[i] < at_v.margins()[i] ? high : low) = at_u.margins()[i] < at_v.margins()[i] ? v : u;
      }
    }
    return std::nullopt;
  }

  /// island_between returns an interval of stable steps between three unstable ones: it searches the maximum of the
  /// least margin, if that comes near 0 between them.
  std::optional<Interval> island_between(const std::array<Look, 3>& last) const {
    const auto least = [](const StepMap& map) { return std::ranges::min(map.margins()); };
    for (const Look& look : last)
      if (look.map.stable()) return std::nullopt;
    const double left = least(last[2].map), here = least(last[1].map), right = least(last[0].map);
    if (!(here >= left && here > right && -here < 2 * here - left - right)) return std::nullopt;
    double low = last[2].u, high = last[0].u;
    while (high - low > 1e-9 * high) {
      const double u = low + (high - low) / 3, v = high - (high - low) / 3;
      const StepMap at_u = map_at(u), at_v = map_at(v);
      if (at_u.stable() || at_v.stable()) {
        const double inside = at_u.stable() ? u : v;
        const bool later = inside > last[1].u;
        return Interval{border(inside, last[later ? 1 : 2].u), border(inside, last[later ? 0 : 1].u)};
      }
      (least(at_u) > least(at_v) ? high : low) = least(at_u) > least(at_v) ? v : u;
    }
    return std::nullopt;
  }

  StepMap (*map_)(std::span<const double>, double, double);
  std::span<const double> settings_;
  double z_, a0_, a_;
};

/// Known holds the stable intervals of a line up to `searched`.
struct Known {
  std::vector<double> line{};
  double searched = 0;
  std::vector<Interval> stable;
};

/// along returns the stable intervals along z = z₁u, a = a₀ + a₁u up to u = needed and somewhat further, but not beyond
/// u = 4096: what is stable there is taken to be stable for all larger u. (A step of 1e100 would ask for 10⁵ maps.)
/// Results are cached for all threads; each thread keeps its last one, since consecutive runs ask for the same. The
/// reference is valid until the thread asks again.
const std::vector<Interval>& along(std::size_t scheme, std::span<const double> settings, double z, double a0, double a,
                                   double needed) {
  constexpr double farthest = 4096;
  needed = std::min(needed, farthest);
  static std::mutex mutex;
  static std::map<std::vector<double>, std::shared_ptr<const Known>> all;
  thread_local std::shared_ptr<const Known> last = std::make_shared<const Known>();
  thread_local std::vector<double> key;
  key.assign(settings.begin(), settings.end());
  if (scheme_entries[scheme].step < key.size()) key[scheme_entries[scheme].step] = 0;
  for (double& x : key)
    if (std::isnan(x)) x = infinite;  // NaN would break the order of the keys
  key.insert(key.end(), {static_cast<double>(scheme), z, a0, a});
  if (last->line == key && last->searched >= needed) return last->stable;
  {
    const std::lock_guard lock(mutex);
    if (const auto found = all.find(key); found != all.end() && found->second->searched >= needed)
      return (last = found->second)->stable;
  }
  double most = 0.25;
  while (most < needed) most *= 2;
  last = std::make_shared<const Known>(Known{key, most, Line(scheme, settings, z, a0, a).stable(most)});
  const std::lock_guard lock(mutex);
  if (all.size() > 1000) all.clear();
  all.insert_or_assign(key, last);
  return last->stable;
}

}  // namespace

double growth_per_step(std::size_t scheme, std::span<const double> settings, double z, double a) {
  return scheme_entries[scheme].map(settings, z, a).radius();
}
bool is_stable(std::size_t scheme, std::span<const double> settings, double z, double a) {
  return scheme_entries[scheme].map(settings, z, a).stable();
}

double flips_from(std::size_t scheme, std::span<const double> settings) {
  return scheme_entries[scheme].flip(settings);
}

double stability_bound(std::size_t scheme, std::span<const double> settings, double a, double needed) {
  if (!scheme_entries[scheme].steps_in_time) return infinite;
  const auto& stable = along(scheme, settings, 1, a, 0, needed);
  return stable.empty() ? 0 : stable.front().high;
}

StableSteps stable_steps(std::size_t scheme, std::span<const double> settings, double omega, double alpha,
                         double longest) {
  const double rate = std::max(omega, alpha);
  StableSteps steps;
  if (!(rate > 0)) return steps;
  auto stable = along(scheme, settings, omega / rate, 0, alpha / rate, longest * rate);
  for (auto& [low, high] : stable) {
    low /= rate;
    high /= rate;
  }
  const bool from_start = !stable.empty() && stable.front().low == 0;
  steps.limit = from_start ? stable.front().high : 0;
  if (from_start) stable.erase(stable.begin());
  for (const Interval& island : stable)
    if (island.low < longest) steps.islands.push_back(island);
  return steps;
}

}  // namespace least
