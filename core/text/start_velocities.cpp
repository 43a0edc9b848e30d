#include "core/text/start_velocities.hpp"

#include <algorithm>
#include <cmath>

#include "core/number/linear.hpp"

namespace least::text {

std::vector<double> velocities_of(const TextScene& scene, std::span<const double> parameters, double t,
                                  const std::vector<double>& state) {
  using Moved = TextScene::Moved;
  constexpr int most_iterations = 50;
  const std::size_t n = scene.form->coordinates, first = static_cast<std::size_t>(scene.capacity);
  std::vector<Moved> with_velocities(state.begin(), state.end());
  std::vector<double> v(n, 0.0), residual(n), mass(n * n);
  double change = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most_iterations && change > 0; ++i) {
    for (std::size_t along = 0; along < n; ++along) {  // a column of ∂p/∂v
      for (std::size_t k = 0; k < n; ++k) with_velocities[first + k] = {v[k], {k == along ? 1.0 : 0.0}};
      std::vector<Moved> moved = with_velocities;
      scene.velocities_to_momenta(parameters, Moved(t), moved);
      for (std::size_t k = 0; k < n; ++k) {
        mass[k * n + along] = moved[first + k].slope[0];
        residual[k] = state[first + k] - moved[first + k].value;
      }
    }
    detail::invert(n, mass.data());
    const double before = change;
    change = 0;
    for (std::size_t k = 0; k < n; ++k) {
      double step = 0;
      for (std::size_t l = 0; l < n; ++l) step += mass[k * n + l] * residual[l];
      v[k] += step;
      change = std::max(change, std::isfinite(step) ? std::abs(step) / std::max(1.0, std::abs(v[k])) : 0.0);
    }
    if (change < 1e-15 || (change < 1e-10 && change >= before)) break;
  }
  return v;
}

}  // namespace least::text
