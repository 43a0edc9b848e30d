// Reference data of contact scenes, computed by an independent implementation (tests/reference/contact.json says how),
// and requests for such scenes.
#pragma once

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/runs.hpp"

namespace contact {

inline const double pi = std::acos(-1.0);

inline const nlohmann::json& data() {
  static const nlohmann::json all = [] {
    std::ifstream file(LEAST_SOURCE_DIR "/tests/reference/contact.json");
    return nlohmann::json::parse(file);
  }();
  return all;
}
/// The reference orbits of a problem.
inline std::vector<const nlohmann::json*> orbits(std::string_view problem) {
  std::vector<const nlohmann::json*> found;
  for (const auto& entry : data().at("states"))
    if (entry.at("problem") == problem) found.push_back(&entry);
  return found;
}

/// request_for() returns the defaults with this step and, where it is not empty, this composition.
inline least::Request request_for(std::string_view problem, std::string_view scheme, std::string_view composition,
                                  double step) {
  least::Request request = runs::defaults(problem, scheme);
  runs::set(request, "step", step);
  if (!composition.empty()) runs::set(request, "composition", composition);
  return request;
}

}  // namespace contact
