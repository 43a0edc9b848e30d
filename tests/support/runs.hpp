// Requests with defaults filled in from the catalogue, and runs that collect their samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "tests/support/turned_clock.hpp"

#ifdef LEAST_LEFT_OUT
#include <gtest/gtest.h>
#endif

namespace runs {

struct Result {
  least::Solution outcome;
  std::vector<std::vector<double>> rows;
};

/// The cards of all problems.
inline const std::vector<least::ProblemCard>& problem_cards() {
  static const std::vector<least::ProblemCard> cards = [] {
    std::vector<least::ProblemCard> all;
    for (const auto& problem : least::problem_list()) all.push_back(problem->card());
    return all;
  }();
  return cards;
}

/// problem_called() returns the problem with this id. It ends the test as skipped where the problem exists but is left
/// out of this build (LEAST_PROBLEMS), and throws where there is no such problem.
inline std::shared_ptr<const least::Mechanics> problem_called(std::string_view id) {
#ifdef LEAST_LEFT_OUT
  using namespace std::string_literals;
  if (const std::string_view left_out = LEAST_LEFT_OUT; left_out.find(" " + std::string(id) + " ") != left_out.npos) {
    [&] { GTEST_SKIP() << "needs " << id; }();
    throw testing::AssertionException({testing::TestPartResult::kSkip, __FILE__, __LINE__, "skipped"});
  }
#endif
  if (auto found = least::find_problem(id)) return found;
  throw std::out_of_range(std::string(id));
}

inline const least::ProblemCard& problem_card(std::string_view id) { return problem_called(id)->card(); }
inline bool fits(const least::ProblemCard& problem, std::size_t scheme) {
  return std::ranges::find(problem.schemes, scheme) != problem.schemes.end();
}
inline bool fits(std::string_view problem, std::string_view scheme) {
  return fits(problem_card(problem), least::find_scheme(scheme).value());
}

/// scene() replaces the request's scene by a copy and returns it to be changed; other requests keep the old one.
inline least::Scene& scene(least::Request& request) {
  auto copy = std::make_shared<least::Scene>(*request.scene);
  request.scene = copy;
  return *copy;
}
inline const least::Scene& scene(const least::Request& request) { return *request.scene; }

/// defaults() returns a request with every default from the cards: columns t and the variables, every step kept; but no
/// diagnostics.
inline least::Request defaults(std::string_view problem, std::string_view scheme) {
  problem_called(problem);  // where it is left out, the test is skipped
  least::Request request = least::default_request(problem, scheme);
  request.diagnostics.clear();
  return request;
}

inline Result go(const least::Request& request) {
  least::Samples samples;
  const std::atomic<bool> cancelled{false};
  Result result{request.scene->mechanics->run(request, samples, cancelled), {}};
  const std::size_t width = request.columns.size();
  for (std::size_t i = 0; width && i + width <= samples.values.size(); i += width)
    result.rows.emplace_back(samples.values.begin() + long(i), samples.values.begin() + long(i + width));
  return result;
}

/// drop_unknown() removes the NaNs, which stand for variables that a run did not carry.
inline void drop_unknown(std::vector<double>& numbers) {
  std::erase_if(numbers, [](double x) { return std::isnan(x); });
}

/// position() returns the position of the element called `name`; it throws std::out_of_range where there is none.
template <class Named, class Name>
std::size_t position(const Named& all, std::string_view name, Name&& name_of) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (std::invoke(name_of, all[i]) == name) return i;
  throw std::out_of_range(std::string(name));
}
inline const least::ProblemCard& card(const least::Request& request) { return request.scene->card(); }

/// regular_start() returns the state of the scene's regular motion at a time t after its singular start; nothing where
/// there is none.
inline std::optional<std::vector<double>> regular_start(const least::Request& request, double t) {
  const auto regular = request.scene->mechanics->regular_start(request.scene->parameters, t);
  if (!regular || !regular->objection.empty()) return std::nullopt;
  return regular->state;
}

/// set() sets a parameter of the problem or a setting of the scheme by its name.
inline void set(least::Request& request, std::string_view name, double value) {
  const auto name_of = [](const auto& p) { return p.name; };
  const auto& parameters = card(request).parameters;
  if (std::ranges::find(parameters, name, name_of) != parameters.end())
    scene(request).parameters[position(parameters, name, name_of)] = value;
  else
    request.settings[position(least::schemes()[request.scheme].parameters, name, name_of)] = value;
}
/// set() sets a choice among named alternatives.
inline void set(least::Request& request, std::string_view name, std::string_view choice) {
  const auto look = [&](const auto& parameters) {
    for (const auto& p : parameters)
      if (p.name == name) return set(request, name, double(position(p.choices, choice, std::identity{}))), true;
    return false;
  };
  if (!look(card(request).parameters) && !look(least::schemes()[request.scheme].parameters))
    throw std::out_of_range(std::string(name));
}
/// begin() sets the start value of a variable by its name; `t` is the time.
inline void begin(least::Request& request, std::string_view name, double value) {
  if (name == "t")
    scene(request).start = value;
  else
    scene(request).initial[position(card(request).variables, name, [](const auto& v) { return v.name; })] = value;
}
/// ask() adds a diagnostic by its name.
inline void ask(least::Request& request, std::string_view diagnostic) {
  request.diagnostics.push_back(position(card(request).diagnostics, diagnostic, [](const auto& d) { return d.name; }));
}
/// show_all() asks for columns t and every variable, also those that the equations of motion do not depend on.
inline void show_all(least::Request& request) {
  request.columns.clear();
  for (std::size_t i = 0; i <= card(request).variables.size(); ++i) request.columns.push_back(i);
}
/// only_final() keeps nothing but the final state.
inline void only_final(least::Request& request) { request.record = {least::Record::Mode::every, 0, {}}; }
/// at_times() asks for the states at these times; the last of them is the end of the run.
inline void at_times(least::Request& request, std::vector<double> times) {
  request.end = times.back();
  request.record = {least::Record::Mode::times, 1, std::move(times)};
}

/// number() returns a number of a report by its path, such as "energy/max_abs_error"; it throws where there is none.
inline double number(const std::vector<least::Report>& reports, std::string_view path) {
  const auto slash = path.find('/');
  for (const auto& report : reports)
    if (report.key == path.substr(0, slash))
      return slash == std::string_view::npos
                 ? std::get<double>(report.value)
                 : number(std::get<std::vector<least::Report>>(report.value), path.substr(slash + 1));
  throw std::out_of_range(std::string(path));
}

/// list() returns a list of a report, such as the times of "zeros"; it throws where there is none.
inline const std::vector<double>& list(const std::vector<least::Report>& reports, std::string_view key) {
  for (const auto& report : reports)
    if (report.key == key) return std::get<std::vector<double>>(report.value);
  throw std::out_of_range(std::string(key));
}

}  // namespace runs
