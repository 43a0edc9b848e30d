#include "core/text/start_velocities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/number/linear.hpp"

namespace least::text {
namespace {

/// Limit of unknown velocities for which the matrix is computed: it takes one evaluation per column, its inverse n³.
constexpr std::size_t most_together = 64;

/// find_velocities finds the velocities at `places` that have these momenta while all others stay, by Newton's
/// iteration, which ends after one step where L is quadratic in the velocities. For more than most_together places the
/// row sums of ∂p/∂v replace the matrix, which is exact where the matrix is diagonal. Returns whether the iteration
/// converged.
bool find_velocities(const TextScene& scene, std::span<const double> parameters, double t,
                     const std::vector<std::size_t>& places, const std::vector<double>& momenta,
                     std::vector<double>& state) {
  using Moved = TextScene::Moved;
  constexpr int most_iterations = 50;
  const std::size_t n = places.size(), first = static_cast<std::size_t>(scene.capacity);
  const bool together = n <= most_together;
  std::vector<double> residual(n), mass(together ? n * n : n), step(n);
  double change = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_iterations; ++i) {
    for (std::size_t along = 0; along < (together ? n : 1); ++along) {  // a column of ∂p/∂v, or the sum of all columns
      std::vector<Moved> moved(state.begin(), state.end());
      for (std::size_t k = 0; k < n; ++k)
        if (!together || k == along) moved[first + places[k]].slope[0] = 1;
      scene.velocities_to_momenta(parameters, Moved(t), moved);
      for (std::size_t k = 0; k < n; ++k) {
        mass[together ? k * n + along : k] = moved[first + places[k]].slope[0];
        residual[k] = momenta[k] - moved[first + places[k]].value;
      }
    }
    if (together) {
      detail::invert(n, mass.data());
      for (std::size_t k = 0; k < n; ++k)
        step[k] = std::inner_product(residual.begin(), residual.end(),
                                     mass.begin() + static_cast<std::ptrdiff_t>(k * n), 0.0);
    } else {
      std::transform(residual.begin(), residual.end(), mass.begin(), step.begin(), std::divides<>());
    }
    const double before = change;
    change = 0;
    bool finite = true;
    for (std::size_t k = 0; k < n; ++k) {
      double& v = state[first + places[k]];
      v += step[k];
      finite = finite && std::isfinite(v);
      change = std::max(change, std::isfinite(step[k]) ? std::abs(step[k]) / std::max(1.0, std::abs(v)) : 0.0);
    }
    if (!finite) return false;
    if (change < 1e-15 || (change < 1e-10 && change >= before)) return true;
  }
  return false;
}

}  // namespace

std::vector<double> velocities_of(const TextScene& scene, std::span<const double> parameters, double t,
                                  const std::vector<double>& state) {
  const auto n = static_cast<std::ptrdiff_t>(scene.form->coordinates);
  std::vector<double> found = state;
  const auto moving = found.begin() + scene.capacity;
  const std::vector<double> momenta(moving, moving + n);
  std::fill(moving, moving + n, 0.0);
  std::vector<std::size_t> places(momenta.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  find_velocities(scene, parameters, t, places, momenta, found);
  return {moving, moving + n};
}

bool make_momenta_of_start(const TextScene& scene, std::span<const double> parameters, double t,
                           const std::vector<std::size_t>& places, const std::vector<double>& momenta,
                           std::vector<double>& state) {
  if (!places.empty() && !find_velocities(scene, parameters, t, places, momenta, state)) return false;
  scene.velocities_to_momenta(parameters, t, state);
  for (std::size_t k = 0; k < places.size(); ++k)
    state[static_cast<std::size_t>(scene.capacity) + places[k]] = momenta[k];
  return true;
}

}  // namespace least::text
