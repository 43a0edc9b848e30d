#include "core/schemes/time_transformed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace least {

std::string kepler_objection(Composition composition, double sigma, double mu, double energy) {
  double weight = 0;
  for (const double gamma : Weights<double>::of(composition).gamma) weight = std::max(weight, std::abs(gamma));
  const double most = energy > 0 ? std::sqrt(3.0) / 2 : std::sqrt(3.0);  // of |z|
  const double bound = 2 * mu * most / (weight * std::sqrt(2 * std::abs(energy)));
  if (!(sigma >= bound)) return {};
  return fmt::format("σ = {:.4g}: with κ = −E₀ on this {} and this composition σ has to be less than {:.4g}", sigma,
                     energy > 0 ? "hyperbola" : "ellipse", bound);
}

}  // namespace least
