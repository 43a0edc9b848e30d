// Runs that ask for one diagnostic, and what the diagnostic says.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/runs.hpp"

namespace least::asks {

inline Request asking(std::string_view problem, std::string_view scheme, std::string_view diagnostic) {
  Request request = runs::defaults(problem, scheme);
  const auto& names = request.scene->card().diagnostics;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i].name == diagnostic) request.diagnostics = {i};
  EXPECT_EQ(request.diagnostics.size(), 1U);
  request.record.count = 0;
  return request;
}
inline double ask(const Request& request, std::string_view path) {
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << result.outcome.stop.detail;
  return runs::number(result.outcome.diagnostics, path);
}
/// word() returns the text of a report by its path; empty where that report is not a text. It throws where there is no
/// such report.
inline std::string word(const std::vector<Report>& reports, std::string_view path) {
  const auto slash = path.find('/');
  for (const auto& report : reports)
    if (report.key == path.substr(0, slash)) {
      if (slash != std::string_view::npos)
        return word(std::get<std::vector<Report>>(report.value), path.substr(slash + 1));
      const auto* text = std::get_if<std::string>(&report.value);
      return text ? *text : "";
    }
  throw std::out_of_range(std::string(path));
}
inline std::string word(const Request& request, std::string_view path) {
  return word(runs::go(request).outcome.diagnostics, path);
}

}  // namespace least::asks
