#include "core/run/diagnostics/watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/run/root.hpp"

namespace least {
namespace {

using Values = std::array<double, most_events>;

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
  Signs signs = 0;
  for (std::size_t i = 0; i < measures_.size(); ++i) signs |= Signs{values[i] < 0} << i;
  return signs;
}

std::vector<Zero> Watch::locate(const double* left, double from, const double* right, double to,
                                const ObserveAt& observe_at) const {
  Values was{}, is{};
  measures_.evaluate(left, from, was.data());
  measures_.evaluate(right, to, is.data());
  std::vector<double> observed(measures_.reads.size());
  std::vector<Zero> zeros;
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    const bool rises = was[i] < 0 && is[i] >= 0, falls = was[i] >= 0 && is[i] < 0;
    if (!((rises && (up_ >> i & 1)) || (falls && (down_ >> i & 1)))) continue;
    if (was[i] == 0 && !(from > start_)) continue;
    const auto value = [&](double t) {
      Values values{};
      if (t == from) return was[i];
      if (t == to) return is[i];
      if (!observe_at(t, observed.data())) return unknown;
      measures_.evaluate(observed.data(), t, values.data());
      return values[i];
    };
    const double t = from + root([&](double part) { return value(part < to - from ? from + part : to); }, 0, to - from);
    // Towards a pole values grow, and interpolation between them may leave the step.
    if (from <= t && t <= to && std::abs(value(t)) <= std::max(std::abs(was[i]), std::abs(is[i])))
      zeros.push_back({t, i});
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
