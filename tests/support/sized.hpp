// Scenes of many coordinates as text, and requests of steps of equal length.
#pragma once

#include <cmath>
#include <limits>

#include "tests/support/texts.hpp"

namespace sized {

using namespace texts;

/// made() returns the mechanics of a scene; it throws where the scene has a fault.
inline std::shared_ptr<const Mechanics> made(text::TypedScene typed) {
  auto mechanics = custom_mechanics(std::move(typed));
  if (const auto* faults = std::get_if<std::vector<text::DefinitionFault>>(&mechanics))
    throw std::invalid_argument(faults->front().pointer + " " + faults->front().fault.detail);
  return std::get<std::shared_ptr<const Mechanics>>(mechanics);
}
inline Request stepped(std::string_view scheme, const std::shared_ptr<const Mechanics>& mechanics,
                       const std::vector<double>& start, double end, double step, const char* composition = "") {
  Request request = request_by(scheme, mechanics, start, end);
  runs::set(request, "step", step);
  if (*composition) runs::set(request, "composition", composition);
  return request;
}
/// distance() returns the largest difference of components; infinity where a component of `a` is not finite.
inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < b.size(); ++i)
    most = std::isfinite(a[i]) ? std::max(most, std::abs(a[i] - b[i])) : std::numeric_limits<double>::infinity();
  return most;
}

}  // namespace sized
