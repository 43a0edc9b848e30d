// Requests with defaults filled in from the catalogue, and runs that collect what they give.
#pragma once

#include <string_view>
#include <vector>

#include "core/catalogue.hpp"

namespace runs {

struct Result {
  least::Outcome outcome;
  std::vector<std::vector<double>> rows;
};

/// Problem and scheme by id, every default from the cards, columns t and the variables, no diagnostics, every step
/// kept.
inline least::Request defaults(std::string_view problem, std::string_view scheme) {
  least::Request request;
  request.problem = least::find_problem(problem).value();
  request.scheme = least::find_scheme(scheme).value();
  const auto& card = least::problems()[request.problem];
  for (const auto& p : card.parameters) request.parameters.push_back(p.value);
  for (const auto& v : card.variables) request.initial.push_back(v.value);
  for (const auto& p : least::schemes()[request.scheme].parameters) {
    double value = p.value;
    for (const auto& [name, suggestion] : card.suggested)
      if (name == p.suggested) value = suggestion;
    request.settings.push_back(value);
  }
  request.end = card.span;
  for (std::size_t i = 0; i <= card.variables.size(); ++i) request.columns.push_back(i);
  return request;
}

inline Result go(const least::Request& request) {
  least::Samples samples;
  const std::atomic<bool> cancelled{false};
  Result result{least::run(request, samples, cancelled), {}};
  const std::size_t width = request.columns.size();
  for (std::size_t i = 0; width && i + width <= samples.values.size(); i += width)
    result.rows.emplace_back(samples.values.begin() + long(i), samples.values.begin() + long(i + width));
  return result;
}

/// A number of a report by its path, as "energy/max_abs_error"; throws where there is none.
inline double number(const std::vector<least::Report>& reports, std::string_view path) {
  const auto slash = path.find('/');
  for (const auto& report : reports)
    if (report.key == path.substr(0, slash))
      return slash == std::string_view::npos
                 ? std::get<double>(report.value)
                 : number(std::get<std::vector<least::Report>>(report.value), path.substr(slash + 1));
  throw std::out_of_range(std::string(path));
}

}  // namespace runs
