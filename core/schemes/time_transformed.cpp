#include "core/schemes/time_transformed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace least {

std::string kepler_objection(const Composition& composition, double sigma, double mu, double energy) {
  double weight = 0;
  for (const double gamma : Weights<double>::of(composition).gamma) weight = std::max(weight, std::abs(gamma));
  const double most = energy > 0 ? std::sqrt(3.0) / 2 : std::sqrt(3.0);  // of |z|
  const double bound = 2 * mu * most / (weight * std::sqrt(2 * std::abs(energy)));
  if (!(sigma >= bound)) return {};
  return fmt::format("σ = {:.4g}: with κ = −E₀ on this {} and this composition σ has to be less than {:.4g}", sigma,
                     energy > 0 ? "hyperbola" : "ellipse", bound);
}

std::string words_of(TransformedFault fault, double kappa, double room) {
  const auto raise = [&](std::string_view what) {
    if (!std::isfinite(room)) return fmt::format("{} is not finite", what);
    return fmt::format(
        "{} = {:.4g} is not positive: a shorter step is needed, or κ = {:.4g} has to be more than {:.4g}, by something "
        "of the order of the kinetic energy",
        what, room, kappa, kappa - room);
  };
  switch (fault) {
    case TransformedFault::standstill:
      return "the time does not advance by a step; a longer one may go on";
    case TransformedFault::pole:
      return "the step is too long against the damping, whose part has a pole within it: a shorter one is needed";
    case TransformedFault::kinetic:
      return raise("K + κ, as the step keeps it,");
    case TransformedFault::potential:
      return raise("E₀ − V + κ");
    case TransformedFault::level:
      return fmt::format(
          "the two parts of the step, equal on the true motion, differ: the square of their ratio is "
          "{:.3g}; a shorter step is needed, or another κ",
          room);
    case TransformedFault::unsolved:
      return "the time that the step takes was not found; a shorter one may be";
  }
  return {};
}

}  // namespace least
