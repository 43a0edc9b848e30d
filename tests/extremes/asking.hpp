// Requests by names, and checks of the numbers of runs, for the tests of extremes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "core/exact/elements.hpp"
#include "tests/support/runs.hpp"

namespace asking {

using least::NamedValue;
using least::Request;
using Named = NamedValue;
using Names = std::initializer_list<std::pair<std::string_view, std::string_view>>;

inline const least::ProblemCard& problem_of(const Request& request) { return runs::card(request); }
inline const least::SchemeCard& scheme_of(const Request& request) { return least::schemes()[request.scheme]; }
inline const double pi = std::acos(-1.0), null = std::nan("");
/// name() returns text such as "kepler leapfrog".
inline std::string name(const Request& request) {
  return std::string(problem_of(request).id) + ' ' + std::string(scheme_of(request).id);
}
inline double number(const runs::Result& result, std::string_view path) {
  return runs::number(result.outcome.diagnostics, path);
}

/// is_adaptive() says whether the scheme's first setting is a tolerance of the error in place of a step.
inline bool is_adaptive(const least::SchemeCard& scheme) { return scheme.parameters.at(0).name == "tolerance"; }
inline bool is_adaptive(const Request& request) { return is_adaptive(scheme_of(request)); }
inline constexpr std::string_view adaptive[] = {"dormand_prince_5", "fehlberg_78", "bulirsch_stoer", "taylor"};

/// set() returns the request with other parameters of its problem or settings of its scheme.
inline Request set(Request request, std::initializer_list<Named> values) {
  for (const auto& [name, value] : values) runs::set(request, name, value);
  return request;
}
inline Request choose(Request request, Names names) {
  for (const auto& [name, choice] : names) runs::set(request, name, choice);
  return request;
}
inline Request at(Request request, std::initializer_list<Named> values) {
  for (const auto& [name, value] : values) runs::begin(request, name, value);
  return request;
}
inline Request ask(Request request, std::initializer_list<std::string_view> diagnostics) {
  for (const std::string_view name : diagnostics) runs::ask(request, name);
  return request;
}
inline Request columns(Request request, std::initializer_list<std::string_view> names) {
  request.columns.clear();
  for (const std::string_view name : names)
    request.columns.push_back(runs::position(problem_of(request).columns, name, &least::ColumnCard::name));
  return request;
}
inline Request steps(Request request, std::int64_t count) {
  request.until_steps = true;
  request.steps = count;
  return request;
}
/// until() returns the request with this end.
inline Request until(Request request, double end) {
  request.end = end;
  return request;
}
/// everything() asks for every column and every diagnostic at once; with `dear` false, without the expensive ones that
/// follow motions of their own.
inline Request everything(Request request, bool dear = true) {
  request.diagnostics.clear();
  request.columns.clear();
  const auto& card = problem_of(request);
  for (std::size_t i = 0; i < card.diagnostics.size(); ++i)
    if (dear || (card.diagnostics[i].name != "error" && card.diagnostics[i].name != "lyapunov"))
      request.diagnostics.push_back(i);
  for (std::size_t i = 0; i < card.columns.size(); ++i)
    if (dear || card.columns[i].name != "error") request.columns.push_back(i);
  return request;
}

struct Scheme {
  std::string_view id;
  std::initializer_list<Named> settings = {};
};
inline Request of(std::string_view problem, const Scheme& scheme, std::initializer_list<Named> parameters) {
  Request request = set(set(runs::defaults(problem, scheme.id), scheme.settings), parameters);
  request.limits.seconds = 2;
  request.limits.steps = 50'000;
  return request;
}

/// known() returns the numbers without the NaNs, which stand for what the run did not carry.
inline std::vector<double> known(std::vector<double> numbers) {
  runs::drop_unknown(numbers);
  return numbers;
}
/// start_of_motion() returns the initial state without the variables that the equations of motion do not depend on.
inline std::vector<double> start_of_motion(const Request& request) {
  std::vector<double> start = runs::scene(request).initial;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (problem_of(request).variables[i].optional) start[i] = std::nan("");
  return known(start);
}

inline bool warned(const runs::Result& result, std::string_view code) {
  return std::ranges::any_of(result.outcome.warnings, [&](const auto& warning) { return warning.code == code; });
}

inline bool slope(const Request& request, std::size_t column) {
  return problem_of(request).columns[column].name == "slope";
}

/// may_be_unknown() says whether a column may be NaN in this row: a slope at its pole or where it is not carried; the
/// length of a step before the first one, where the scheme chooses it; the error where there is no true solution;
/// elements of an orbit, whose squares of large numbers overflow; the mode of a scheme without modes; the parameter
/// coordinate of a step in time.
inline bool may_be_unknown(const Request& request, const runs::Result& result, std::size_t row, std::size_t column) {
  const std::string_view name = problem_of(request).columns[request.columns[column]].name;
  const bool hybrid = scheme_of(request).id == "jacobi_maupertuis";
  if (name == "step_size") return row == 0 && scheme_of(request).own_clock;
  if (name == "mode") return !hybrid;
  if (name == "error") return true;
  if (std::ranges::find(least::two_body::element_names, name) != least::two_body::element_names.end())
    return true;                               // they overflow
  if (name == "discrete_energy") return true;  // DiscreteEnergy
  if (name != "parameter") return slope(request, request.columns[column]);
  const auto& columns = problem_of(request).columns;
  for (std::size_t i = 0; i < request.columns.size(); ++i)
    if (columns[request.columns[i]].name == "mode" && result.rows[row][i] == 1) return warned(result, "steps_in_time");
  return true;
}

/// go() runs the request and checks that its numbers are finite: rows (except what may be unknown), final state and
/// cost.
inline runs::Result go(const Request& request) {
  auto result = runs::go(request);
  const std::string what = std::string(problem_of(request).id) + ' ' + std::string(scheme_of(request).id);
  for (std::size_t k = 0; k < result.rows.size(); ++k)
    for (std::size_t i = 0; i < result.rows[k].size(); ++i) {
      const double x = result.rows[k][i];
      const bool good = std::isfinite(x) || may_be_unknown(request, result, k, i);
      EXPECT_TRUE(good) << what << ": " << problem_of(request).columns[request.columns[i]].name << " in row " << k;
      if (!good) return result;
    }
  for (std::size_t i = 0; i < result.outcome.final.size(); ++i) {
    const bool may_lack = problem_of(request).variables[i].optional;  // not carried, or overflown
    EXPECT_TRUE(std::isfinite(result.outcome.final[i]) || (may_lack && std::isnan(result.outcome.final[i])))
        << what << ": final " << problem_of(request).variables[i].name;
  }
  EXPECT_TRUE(std::isfinite(result.outcome.cost.seconds));
  const least::Termination& stop = result.outcome.stop;
  if (stop.reason != least::ReturnCode::completed) {
    EXPECT_FALSE(stop.detail.empty()) << what;
    EXPECT_EQ(stop.t, result.outcome.t) << what;
  }
  if (stop.singular_at.has_value()) {
    // Ten steps ahead, or a tenth of the way; where a scheme of adaptive steps leaves a domain, within that step; and
    // where no step leads from the start, anywhere ahead.
    const least::SchemeCard& scheme = scheme_of(request);
    const double way = stop.t - runs::scene(request).start;
    const double steps = static_cast<double>(std::max<std::int64_t>(stop.step, 1));
    const double ten = 10 * (scheme.own_clock ? way / steps : request.settings[*scheme.find("step")]);
    const double behind = std::max(ten, 0.1 * way), ahead = scheme.own_clock ? behind : ten;
    const bool anywhere = stop.step == 0 || (scheme.own_clock && stop.reason == least::ReturnCode::left_domain);
    EXPECT_GE(*stop.singular_at, stop.t - behind) << what;
    EXPECT_LE(*stop.singular_at, anywhere ? 1e300 : stop.t + ahead) << what;
  }
  return result;
}
inline least::ReturnCode reason(const Request& request) { return go(request).outcome.stop.reason; }

/// value() returns the number of a row in the column of that name.
inline double value(const Request& request, const std::vector<double>& row, std::string_view name) {
  const auto& known = problem_of(request).columns;
  return row[runs::position(request.columns, name, [&](std::size_t column) { return known[column].name; })];
}
inline double largest(const Request& request, const runs::Result& result, std::string_view name) {
  double most = 0;
  for (const auto& row : result.rows) most = std::max(most, std::abs(value(request, row, name)));
  return most;
}

}  // namespace asking
