#include "core/run/outcome.hpp"

#include <algorithm>

namespace least {

Report numbers(std::string_view key, std::initializer_list<std::pair<std::string_view, double>> parts) {
  std::vector<Report> all;
  for (const auto& [name, x] : parts) all.push_back({std::string(name), x});
  return {std::string(key), std::move(all)};
}

Report words(std::string_view key, std::string_view text) {
  Report report{std::string(key), std::monostate{}};
  if (!text.empty()) report.value = std::string(text);
  return report;
}

namespace {

/// bytes_of estimates the memory of a report, with the reserve of a list of them.
std::size_t bytes_of(const Report& report) {
  std::size_t bytes = 2 * sizeof(Report) + 16;
  if (const auto* parts = std::get_if<std::vector<Report>>(&report.value))
    for (const Report& part : *parts) bytes += bytes_of(part);
  return bytes;
}

}  // namespace

void Solution::add_event(Report report) {
  held.add(bytes_of(report));
  events.push_back(std::move(report));
}

void Solution::extend_event(Report part) {
  held.add(bytes_of(part));
  std::get<std::vector<Report>>(events.back().value).push_back(std::move(part));
}

void insert(Report& report, std::size_t place, Report part) {
  auto& parts = std::get<std::vector<Report>>(report.value);
  parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(std::min(place, parts.size())), std::move(part));
}

}  // namespace least
