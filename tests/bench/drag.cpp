// Table of RESULTS.md: ten thousand revolutions under a weak drag, at equal work. Printed before the benchmarks.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/state_error.hpp"
#include "core/study/error_study.hpp"
#include "tests/bench/equal_work.hpp"
#include "tests/bench/table.hpp"

namespace {

using namespace least;

/// Semi-major axis, eccentricity and direction of the periapsis of the osculating ellipse, μ = 1.
std::array<double, 3> elements(const double* x) {
  const double r = std::hypot(x[0], x[1]), pp = x[2] * x[2] + x[3] * x[3], qp = x[0] * x[2] + x[1] * x[3];
  const double ex = (pp - 1 / r) * x[0] - qp * x[2], ey = (pp - 1 / r) * x[1] - qp * x[3];
  return {1 / (2 / r - pp), std::hypot(ex, ey), std::atan2(ey, ex)};
}

struct Case {
  const char *scheme, *composition;  // nullptr: the scheme has none
};

/// request_of() requests the preset `weak` by one scheme, with this value of the setting that determines its accuracy.
Request request_of(const Case& c, double value, const std::vector<double>& times) {
  Request request = runs::defaults("damped_kepler", c.scheme);
  const ProblemCard& card = runs::card(request);
  for (const PresetCard& preset : card.presets) {
    if (preset.name != "weak") continue;
    for (const auto& [name, number] : preset.parameters) runs::set(request, name, number);
    for (const auto& [name, number] : preset.initial) runs::begin(request, name, number);
  }
  if (c.composition) runs::set(request, "composition", c.composition);
  const ResolutionParameter dial(schemes()[request.scheme]);
  request.settings = dial.at({request.scheme, request.settings}, value).settings;
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::at_times(request, times);
  request.columns = {1, 2, 3, 4};
  return request;
}

/// value_for() returns the value of that setting, between 1e-14 and 10, at which a short run spends its share of the
/// work.
double value_for(const Case& c, double forces, double span) {
  double low = std::log(1e-14), high = std::log(10);
  for (int k = 0; k < 40; ++k) {
    const double middle = (low + high) / 2;
    Request request = request_of(c, std::exp(middle), {span});
    request.limits.steps = static_cast<std::int64_t>(2 * forces);
    const auto outcome = runs::go(request).outcome;
    const bool fine =
        outcome.stop.reason == ReturnCode::step_limit || static_cast<double>(outcome.cost.force_evaluations) > forces;
    (fine ? low : high) = middle;
  }
  return std::exp(high);
}

}  // namespace

void bench::drag() {
  constexpr double revolutions = 10'000, budget = 2e6;  // force evaluations
  const double turn = 2 * std::acos(-1.0);
  constexpr std::array parts{0.25, 0.5, 1.0};
  constexpr int looks = 16;  // samples of a revolution: errors oscillate along the orbit
  std::vector<double> times;
  for (const double part : parts)
    for (int k = 1; k <= looks; ++k) times.push_back((part * revolutions - 1 + double(k) / looks) * turn);
  const Request any = request_of({"contact_splitting", "none"}, 0.1, times);
  const auto truth = least::truth(*any.scene, times, [] { return true; });
  const auto last = elements(truth->states.back().data());

  bench::heading("A weak drag for ten thousand revolutions");
  std::printf(
      "`damped_kepler` from its preset `weak` (e = 0.5, α = 1e-6), about %.0f force evaluations each: the largest\n"
      "errors in the revolutions that end with the 2,500th, 5,000th and 10,000th, and what the elements at the end "
      "are\n"
      "off by.\n\n"
      "| scheme | setting | force evaluations | ms | error, 2,500 | 5,000 | 10,000 | a | e | ω |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      budget);
  for (const Case& c : {Case{"time_transformed", "kahan_li_6"},
                        {"time_transformed", "kahan_li_8"},
                        {"contact_splitting", "kahan_li_6"},
                        {"contact_splitting", "kahan_li_8"},
                        {"fehlberg_78", nullptr}}) {
    const double value = value_for(c, budget / 100, times.back() / 100);
    const auto result = runs::go(request_of(c, value, times));
    const SchemeCard& card = schemes()[*find_scheme(c.scheme)];
    const std::string symbol = card.parameters[ResolutionParameter(card).index].symbol;
    const std::string setting = (c.composition ? std::string(c.composition) + ", " : "") + symbol;
    std::printf("| `%s` | %s = %.3g | %lld | %.0f |", c.scheme, setting.c_str(), value,
                static_cast<long long>(result.outcome.cost.force_evaluations), 1e3 * result.outcome.cost.seconds);
    for (std::size_t part = 0, i = 0; part < parts.size() && i + looks <= result.rows.size(); ++part) {
      double most = 0;
      for (const std::size_t end = i + looks; i < end; ++i)
        most = std::max(most, state_error(result.rows[i].data(), truth->states[i], 4));
      std::printf(" %.1e |", most);
    }
    if (result.rows.size() == times.size()) {
      const auto is = elements(result.rows.back().data());
      for (std::size_t i = 0; i < is.size(); ++i) std::printf(" %.1e |", is[i] - last[i]);
    }
    std::printf("%s\n", result.outcome.stop.reason == ReturnCode::completed ? "" : " stopped");
  }
}
