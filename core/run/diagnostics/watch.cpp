#include "core/run/diagnostics/watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/run/root.hpp"

namespace least {
namespace {

using Values = Watch::Looks::Values;

/// Whether between the last two of three values of one sign there may be two zeros: what bends away from zero lies
/// beyond the line through the first two, so that this has to come down to zero.
bool may_dip(double t0, double g0, double t1, double g1, double t, double g) {
  const double slope = (g1 - g0) / (t1 - t0), sign = g < 0 ? -1 : 1;
  return sign * ((g - g1) / (t - t1) - slope) > 0 && sign * (g1 + slope * (t - t1)) <= 0;
}

}  // namespace

Watch::Watch(const Request& request) : measures_(request.watched), start_(request.scene->start) {
  for (std::size_t i = 0; i < request.events.size(); ++i) {
    const Signs bit = Signs{1} << i;
    const EventAsked& asked = request.events[i];
    if (asked.direction >= 0) up_ |= bit;
    if (asked.direction <= 0) down_ |= bit;
    if (asked.stop) halting_ |= bit;
  }
}

Watch::Signs Watch::signs(const double* observed, double t) const {
  Values values;  // NOLINT: written before it is read
  measures_.evaluate(observed, t, values.data());
  return signs(values);
}

Watch::Signs Watch::signs(const Values& values) const {
  Signs signs = 0;
  for (std::size_t i = 0; i < measures_.size(); ++i) signs |= Signs{values[i] < 0} << i;
  return signs;
}

Watch::Signs Watch::look(Looks& looks, const double* observed, double t) const {
  Values values;  // NOLINT: written before it is read
  measures_.evaluate(observed, t, values.data());
  const Signs now = signs(values);
  Signs passed = changed(looks.signs, now);
  const bool begins = !(looks.t_before < looks.t_last);  // nothing is known of what was before
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    const Signs bit = Signs{1} << i;
    if (((looks.signs ^ now) & bit) == 0 &&
        (begins || may_dip(looks.t_before, looks.before[i], looks.t_last, looks.last[i], t, values[i])))
      passed |= bit;
    looks.before[i] = looks.last[i];
    looks.last[i] = values[i];
  }
  looks.t_before = std::exchange(looks.t_last, t);
  looks.signs = now;
  return passed;
}

std::vector<Zero> Watch::locate(const double* left, double from, const double* right, double to,
                                const ObserveAt& observe_at) const {
  Values was{}, is{};
  measures_.evaluate(left, from, was.data());
  measures_.evaluate(right, to, is.data());
  std::vector<double> observed(measures_.reads.size());
  std::vector<Zero> zeros;
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    const auto value = [&](double t) {
      Values values{};
      if (t == from) return was[i];
      if (t == to) return is[i];
      if (!observe_at(t, observed.data())) return unknown;
      measures_.evaluate(observed.data(), t, values.data());
      return values[i];
    };
    const auto add = [&](double a, double b) {
      const double before = value(a), after = value(b);
      const bool rises = before < 0 && after >= 0, falls = before >= 0 && after < 0;
      if (!((rises && (up_ >> i & 1)) || (falls && (down_ >> i & 1)))) return;
      if (before == 0 && !(a > start_)) return;
      const double t = a + root([&](double part) { return value(part < b - a ? a + part : b); }, 0, b - a);
      // Towards a pole values grow, and interpolation between them may leave the step.
      if (a <= t && t <= b && std::abs(value(t)) <= std::max(std::abs(before), std::abs(after)))
        zeros.push_back({t, i});
    };
    const double sign = is[i] < 0 ? -1 : 1;
    std::optional<double> between;
    if ((was[i] < 0) == (is[i] < 0)) between = dip([&](double t) { return sign * value(t); }, from, to);
    if (between) {
      add(from, *between);
      add(*between, to);
    } else {
      add(from, to);
    }
  }
  std::ranges::stable_sort(zeros, {}, &Zero::t);
  const auto end = std::ranges::find_if(zeros, [&](const Zero& zero) { return ends(zero.which); });
  if (end != zeros.end()) zeros.erase(end + 1, zeros.end());
  return zeros;
}

std::vector<std::size_t> Watch::reached(const double* left, double from, const double* right, double to) const {
  Values was{}, is{};
  measures_.evaluate(left, from, was.data());
  measures_.evaluate(right, to, is.data());
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < measures_.size(); ++i)
    if (was[i] > 0 && is[i] == 0 && (down_ >> i & 1)) all.push_back(i);
  return all;
}

double Watch::time(const Report& event) {
  return std::get<double>(std::get<std::vector<Report>>(event.value).front().value);
}

Report Watch::event(const Zero& zero, const ProblemCard& problem, const std::vector<double>& state) const {
  std::vector<Report> numbers;
  for (std::size_t i = 0; i < state.size(); ++i)
    if (!problem.variables[i].hidden && std::isfinite(state[i]))
      numbers.push_back({problem.variables[i].name, state[i]});
  return {"",
          std::vector<Report>{
              {"t", zero.t}, words("kind", "event"), words("name", name(zero.which)), {"state", std::move(numbers)}}};
}

}  // namespace least
