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

void insert(Report& report, std::size_t place, Report part) {
  auto& parts = std::get<std::vector<Report>>(report.value);
  parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(std::min(place, parts.size())), std::move(part));
}

}  // namespace least
