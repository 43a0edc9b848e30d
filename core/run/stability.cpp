#include "core/run/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

#include "core/from_values.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/harmonic_oscillator.hpp"
#include "core/schemes/list.hpp"

namespace least {
namespace {

/// A step of length 1 of a scheme whose parameter `step` is 1.
template <class Scheme, class P>
StepStatus unit_step(const Scheme& scheme, const P& oscillator, State<1>& x) {
  if constexpr (SelfTimed<Scheme>) {
    return scheme.bind(oscillator, x, energy(oscillator, x)).step(x);
  } else {
    return scheme.bind(oscillator, x).step(x, 1);
  }
}

/// Whether the powers of one step of length 1 from (1, 0) and (0, 1) stay bounded.
template <class Scheme, class P>
bool stable(const Scheme& scheme, const P& oscillator, double z) {
  double m[2][2];
  for (int k = 0; k < 2; ++k) {
    State<1> x{0, {k == 0 ? 1.0 : 0.0}, {k == 1 ? 1.0 : 0.0}, {}};
    if (unit_step(scheme, oscillator, x) != StepStatus::ok) return false;
    m[0][k] = x.q[0];
    m[1][k] = x.p[0];
  }
  const double half = (m[0][0] + m[1][1]) / 2, det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  const double root = half * half - det;  // eigenvalues half ± √root
  const double radius = root > 0 ? std::abs(half) + std::sqrt(root) : std::sqrt(det);
  return radius <= 1 + 1e-9 * z;
}

/// What is known of a bound: it lies beyond `cleared`, or there.
struct Known {
  double cleared = 0;
  bool found = false;
};

/// More of it: up to the bound, or to `needed`.
template <class Scheme>
Known measure(std::span<const double> settings, double damping_step, Known known, double needed) {
  constexpr double most = 20, spacing = 0.01;
  auto scheme = from_values<Scheme>(Scheme::fields, settings);
  if constexpr (requires { scheme.step; }) scheme.step = 1;
  if constexpr (requires { scheme.in_time(); }) {
    scheme = scheme.in_time();
  } else if constexpr (SelfTimed<Scheme>) {
    return {std::numeric_limits<double>::infinity(), true};
  }
  const auto holds = [&](double z) {
    if constexpr (FixedStepSchemeFor<Scheme, problems::HarmonicOscillator<>> ||
                  SelfTimedSchemeFor<Scheme, problems::HarmonicOscillator<>>) {
      if (damping_step == 0) return stable(scheme, problems::HarmonicOscillator<>{1, z * z}, z);
    }
    if constexpr (FixedStepSchemeFor<Scheme, problems::DampedOscillator<>>) {
      return stable(scheme, problems::DampedOscillator<>{z * z, damping_step}, z);
    } else {
      return false;
    }
  };
  double low = known.cleared, high = low + spacing;
  while (holds(high)) {
    if (high > most) return {std::numeric_limits<double>::infinity(), true};
    low = high;
    high += spacing;
    if (low > needed) return {low, false};
  }
  while (low > 0 && high - low > 1e-7) (holds((low + high) / 2) ? low : high) = (low + high) / 2;
  return {low, true};
}

/// The setting that everything is scaled by; beyond the last where there is none.
template <class Scheme>
constexpr std::size_t step_setting() {
  std::size_t i = 0;
  std::apply([&](const auto&... field) { (void)((field.name == "step" || (++i, false)) || ...); }, Scheme::fields);
  return i;
}

struct Measure {
  Known (*measure)(std::span<const double>, double, Known, double);
  std::size_t step;
};
template <class... Scheme>
constexpr std::array<Measure, sizeof...(Scheme)> measures(std::tuple<Scheme...>*) {
  return {Measure{&measure<Scheme>, step_setting<Scheme>()}...};
}

}  // namespace

double stability_bound(std::size_t scheme, std::span<const double> settings, double damping_step, double needed) {
  static constexpr auto table = measures(static_cast<SchemeList*>(nullptr));
  static std::mutex mutex;
  static std::map<std::vector<double>, Known> all;
  std::vector<double> key(settings.begin(), settings.end());
  if (table[scheme].step < key.size()) key[table[scheme].step] = 0;
  for (double& x : key)
    if (std::isnan(x)) x = std::numeric_limits<double>::infinity();  // keys are ordered
  key.push_back(static_cast<double>(scheme));
  key.push_back(damping_step);
  Known known;
  {
    const std::lock_guard lock(mutex);
    if (const auto found = all.find(key); found != all.end()) known = found->second;
  }
  if (!known.found && !(known.cleared > needed)) {
    known = table[scheme].measure(settings, damping_step, known, needed);
    const std::lock_guard lock(mutex);
    if (all.size() > 1000) all.clear();
    all.insert_or_assign(std::move(key), known);
  }
  return known.found ? known.cleared : std::numeric_limits<double>::infinity();
}

double longest_stable_step(std::size_t scheme, std::span<const double> settings, double omega, double alpha, double h) {
  double low = 0, high = h;
  for (int k = 0; k < 30; ++k) {
    const double middle = (low + high) / 2;
    (stability_bound(scheme, settings, std::max(alpha * middle, 0.0)) > omega * middle ? low : high) = middle;
  }
  return low;
}

}  // namespace least
