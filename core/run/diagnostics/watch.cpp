#include "core/run/diagnostics/watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "core/run/messages.hpp"
#include "core/run/root.hpp"

namespace least {
namespace {

using interval::Enclosure;
using interval::RateEnclosure;

/// with_ends returns observe_at with the known observations at both ends.
Watch::ObserveAt with_ends(const double* left, double from, const double* right, double to,
                           const Watch::ObserveAt& observe_at, std::size_t count) {
  return [=, &observe_at](double t, double* observed) {
    if (t != from && t != to) return observe_at(t, observed);
    std::copy_n(t == from ? left : right, count, observed);
    return true;
  };
}

/// place_of_change returns a point between a and b, where values have different signs, at which the sign changes, or
/// values are NaN.
template <class F>
double place_of_change(F&& value, double a, double b) {
  const bool negative = value(a) < 0;
  for (double middle = a + (b - a) / 2; a < middle && middle < b; middle = a + (b - a) / 2) {
    const double here = value(middle);
    if (std::isnan(here)) return middle;
    ((here < 0) == negative ? a : b) = middle;
  }
  return b;
}

}  // namespace

Watch::Watch(const Request& request) : measures_(request.watched), start_(request.scene->start) {
  for (std::size_t i = 0; i < request.events.size(); ++i) {
    const Signs bit = Signs{1} << i;
    const EventAsked& asked = request.events[i];
    if (asked.direction >= 0) up_ |= bit;
    if (asked.direction <= 0) down_ |= bit;
    if (asked.stop || asked.act) halting_ |= bit;
  }
  for (std::size_t i = 0; i < measures_.reads.size(); ++i)
    if (measures_.reads[i]) read_.push_back(i);
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

void Watch::note(Looks& looks, const double* observed, double t) const {
  const std::size_t width = measures_.reads.size();
  looks.observed.resize(Looks::most * width);
  looks.last = (looks.last + 1) % Looks::most;
  looks.t[looks.last] = t;
  double* row = &looks.observed[looks.last * width];
  for (const std::size_t i : read_) row[i] = observed[i];
}

Watch::Signs Watch::look(Looks& looks, const double* observed, double t) const {
  note(looks, observed, t);
  return look_back(looks, 0, 1);
}

bool Watch::collect(Looks& looks, const double* observed, double t) const {
  note(looks, observed, t);
  return ++looks.waiting == Looks::together && settle(looks);
}

bool Watch::settle(Looks& looks) const {
  const std::size_t count = std::exchange(looks.waiting, 0);
  return count > 0 && may_vanish(looks, 0, count);
}

bool Watch::may_vanish(const Looks& looks, std::size_t back, std::size_t count) const {
  if (look_back(looks, back, count) == 0) return false;
  return count == 1 || may_vanish(looks, back + count / 2, count - count / 2) || may_vanish(looks, back, count / 2);
}

Watch::Signs Watch::look_back(const Looks& looks, std::size_t back, std::size_t count) const {
  const std::size_t width = measures_.reads.size();
  const auto place = [&](std::size_t ago) { return (looks.last + Looks::most - back - ago) % Looks::most; };
  const double to = looks.t[place(0)], from = looks.t[place(count)], step = to - looks.t[place(1)];
  constexpr double even = 1e-3;
  for (std::size_t ago = 1; ago < count + 2; ++ago)
    if (!(std::abs(looks.t[place(ago)] - looks.t[place(ago + 1)] - step) <= even * step)) return all();

  thread_local std::vector<Enclosure> boxes;
  thread_local std::vector<double> bends;
  if (boxes.size() < width) boxes.resize(width), bends.resize(width);
  std::array<const double*, Looks::together + 3> rows;  // NOLINT: written before it is read
  for (std::size_t ago = 0; ago < count + 3; ++ago) rows[ago] = &looks.observed[place(ago) * width];
  for (const std::size_t i : read_) {
    // Twice the largest second difference, including that of the step before, bounds the curvature within a step.
    double low = rows[0][i], high = low, change = low - rows[1][i], bend = 0;
    for (std::size_t ago = 1; ago < count + 2; ++ago) {
      const double before = rows[ago][i] - rows[ago + 1][i];
      bend = std::max(bend, std::abs(std::exchange(change, before) - before));
      low = std::min(low, rows[std::min(ago, count)][i]);
      high = std::max(high, rows[std::min(ago, count)][i]);
    }
    bends[i] = 2 * bend;
    boxes[i] = {low - bend / 4, high + bend / 4};
  }
  std::array<Enclosure, most_watched> values;
  measures_.enclose(boxes.data(), {from, to}, values.data());
  Signs passed = 0;
  for (std::size_t i = 0; i < measures_.size(); ++i)
    passed |= Signs{values[i].contains(0) && values[i].defined != interval::Defined::nowhere} << i;
  if (passed == 0 || count > 1) return passed;

  thread_local std::vector<RateEnclosure> flows;
  if (flows.size() < width) flows.resize(width);
  for (const std::size_t i : read_) {
    const double change = rows[0][i] - rows[1][i];
    flows[i] = {boxes[i], {(change - bends[i]) / step, (change + bends[i]) / step}};
  }
  std::array<RateEnclosure, most_watched> rates;
  measures_.enclose(flows.data(), {{from, to}, 1.0}, rates.data());
  const Signs moved = changed(signs(rows[1], from), signs(rows[0], to));
  for (std::size_t i = 0; i < measures_.size(); ++i)
    if (rates[i].monotone()) passed &= moved | ~(Signs{1} << i);
  return passed;
}

bool Watch::may_vanish(const double* left, double from, const double* right, double to, const ObserveAt& observe_at,
                       int pieces) const {
  const ObserveAt observe = with_ends(left, from, right, to, observe_at, measures_.reads.size());
  return ZeroSearch(measures_, observe, 0).may_find(from, to, pieces);
}

std::vector<Zero> Watch::locate(const double* left, double from, const double* right, double to,
                                const ObserveAt& observe_at, int pieces) {
  std::vector<double> middle(measures_.reads.size());
  if (acted_ == 0 || !(from < soon_ && soon_ < to) || !observe_at(soon_, middle.data()))
    return search(left, from, right, to, observe_at, pieces);
  // A step may be so long that the time to the next zero is negligible beside it: before a ball bounces for the
  // thousandth time, its series follows the parabola to the end of the run.
  std::vector<Zero> zeros = search(left, from, middle.data(), soon_, observe_at, pieces);
  if (std::ranges::any_of(zeros, [&](const Zero& zero) { return ends(zero.which); })) return zeros;
  const std::vector<Zero> later = search(middle.data(), soon_, right, to, observe_at, pieces);
  zeros.insert(zeros.end(), later.begin(), later.end());
  return zeros;
}

std::vector<Zero> Watch::search(const double* left, double from, const double* right, double to,
                                const ObserveAt& observe_at, int pieces) {
  // A run with so many unresolved searches should end soon.
  constexpr int much = 1 << 13, little = 64;
  constexpr std::int64_t patience = 4;
  constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
  const ObserveAt observe = with_ends(left, from, right, to, observe_at, measures_.reads.size());
  ZeroSearch zero_search(measures_, observe, unresolved_.steps < patience ? much : little);
  zero_search.find(from, to, pieces);
  std::vector<double> observed(measures_.reads.size());
  std::vector<Zero> zeros;
  Signs unresolved = zero_search.unresolved();
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    const auto value = [&](double t) {
      Values values{};
      if (!observe(t, observed.data())) return unknown;
      measures_.evaluate(observed.data(), t, values.data());
      return values[i];
    };
    const auto& brackets = zero_search.brackets(i);
    for (auto next = brackets.begin(); next != brackets.end();) {
      const double a = next->from;
      double b = next->to, noise = next->noise;
      const ZeroSearch::Kind kind = next->kind;
      ++next;
      double after = value(b);
      // If round-off determines the sign of a value, the next value counts.
      for (; next != brackets.end() && next->from == b && std::abs(after) <= noise &&
             next->kind != ZeroSearch::Kind::edge;
           ++next) {
        b = next->to;
        after = value(b);
        noise = std::max(noise, next->noise);
      }
      const double before = value(a);
      const bool rises = before < 0 && after >= 0, falls = before >= 0 && after < 0;
      if (!((rises && (up_ >> i & 1)) || (falls && (down_ >> i & 1)))) continue;
      if (before == 0 && !(a > start_)) continue;
      if (kind == ZeroSearch::Kind::round_off && a == from && b == to &&
          std::max(std::abs(before), std::abs(after)) <= noise) {
        unresolved |= Signs{1} << i;
        continue;
      }
      const double t = kind == ZeroSearch::Kind::edge
                           ? place_of_change(value, a, b)
                           : a + root([&](double part) { return value(part < b - a ? a + part : b); }, 0, b - a);
      // Towards a pole values grow, and interpolation between them may leave the step. A gap, as in q^2/q, is not a
      // zero.
      constexpr double near = 1e-9;
      if ((acted_ >> i & 1) && t - start_ <= near * (to - from) + rounding * std::abs(start_)) continue;
      if (a <= t && t <= b && !(std::abs(value(t)) > std::max(std::abs(before), std::abs(after))))
        zeros.push_back({t, i});
    }
  }
  if (unresolved != 0 && unresolved_.steps++ == 0) unresolved_.at = to;
  unresolved_.which |= unresolved;
  std::ranges::stable_sort(zeros, {}, &Zero::t);
  const auto end = std::ranges::find_if(zeros, [&](const Zero& zero) { return ends(zero.which); });
  if (end != zeros.end()) {
    const double instant = end->t + rounding * std::max(std::abs(end->t), to - from);
    zeros.erase(std::find_if(end, zeros.end(), [&](const Zero& zero) { return zero.t > instant; }), zeros.end());
  }
  return zeros;
}

void Watch::warn(std::vector<Warning>& warnings) const {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < measures_.size(); ++i)
    if (unresolved_.which >> i & 1) names.push_back(name(i));
  if (!names.empty()) warnings.push_back({"events_unresolved", messages::unresolved(names, unresolved_.at)});
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

namespace {

std::vector<Report> by_name(const ProblemCard& problem, const std::vector<double>& state) {
  std::vector<Report> numbers;
  for (std::size_t i = 0; i < state.size(); ++i)
    if (!problem.variables[i].hidden && std::isfinite(state[i]))
      numbers.push_back({problem.variables[i].name, state[i]});
  return numbers;
}

}  // namespace

Report Watch::event(const Zero& zero, const ProblemCard& problem, const std::vector<double>& state) const {
  return {
      "",
      std::vector<Report>{
          {"t", zero.t}, words("kind", "event"), words("name", name(zero.which)), {"state", by_name(problem, state)}}};
}

Report Watch::after(const ProblemCard& problem, const std::vector<double>& state) {
  return {"after", by_name(problem, state)};
}

}  // namespace least
