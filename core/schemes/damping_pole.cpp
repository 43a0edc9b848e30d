#include "core/schemes/damping_pole.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>

namespace least {

std::string unsupported_by_pole(const Composition& composition, double damping_step) {
  const double negative = largest_negative_weight(composition);
  if (damping_step <= -2)
    return fmt::format("αh = {:.4g}: the scheme has a pole at αh = −2, take a shorter step", damping_step);
  if (negative > 0 && damping_step * negative >= 2)
    return fmt::format(
        "αh = {:.4g}: with this composition, whose largest negative weight is {:.4g}, the scheme has a pole at αh = "
        "{:.4g}; take a shorter step",
        damping_step, negative, 2 / negative);
  return {};
}

double flips_from(const Composition& composition) {
  const auto& weights = Weights<double>::of(composition);
  const std::span all(weights.gamma.data(), static_cast<std::size_t>(weights.stages));
  double least = std::numeric_limits<double>::infinity();
  for (const double weight : all)
    if (weight > 0 && std::ranges::count(all, weight) % 2 == 1) least = std::min(least, 2 / weight);
  return least;
}

}  // namespace least
