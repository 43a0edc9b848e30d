#include "core/catalogue/sized_energy_level.hpp"

#include "core/catalogue/metric_step.hpp"
#include "core/catalogue/sized_herglotz.hpp"

namespace least {
namespace {

/// energy_on_a_metric is energy_of_first_step if the metric depends on q: H at the means of places and momenta of the
/// step, one direction at a time.
EnergyLevel energy_on_a_metric(const text::SizedScene& scene, const double* x, double step) {
  const std::size_t size = 2 * scene.coordinates;
  EnergyLevel level{0, std::vector<double>(size)};
  SizedHerglotz<Slope> stepper(scene, SizedPath::straight, Composition::none);
  for (std::size_t j = 0; j < size; ++j) {
    std::vector<Slope> from(x, x + size);
    from[j].slope[0] = 1;
    std::vector<Slope> to = from;
    if (stepper.step(to.data(), 0, step) != StepStatus::ok) return energy_of_start(scene, x);
    for (std::size_t i = 0; i < size; ++i) to[i] = 0.5 * (from[i] + to[i]);
    const Slope energy = hamiltonian_at(scene, to.data());
    level.value = energy.value;
    level.slopes[j] = energy.slope[0];
  }
  return level;
}

EnergyLevel beside_constant(const text::SizedScene& scene, EnergyLevel level) {
  level.value -= scene.constant_potential;
  return level;
}

}  // namespace

EnergyLevel energy_of_start(const text::SizedScene& scene, const double* x) {
  const std::size_t n = scene.coordinates;
  EnergyLevel level{0, std::vector<double>(2 * n)};
  if (!scene.has_constant_metric()) {
    std::vector<double> rates(2 * n);
    scene.rate.evaluate(x, 0.0, rates.data());
    for (std::size_t i = 0; i < n; ++i) {
      level.slopes[i] = -rates[n + i];
      level.slopes[n + i] = rates[i];
    }
    level.value = hamiltonian_at(scene, x);
    return level;
  }
  scene.gradient.evaluate(x, 0.0, level.slopes.data());
  scene.velocity(x + n, &level.slopes[n]);
  scene.potential.evaluate(x, 0.0, &level.value);
  for (std::size_t i = 0; i < n; ++i) level.value += 0.5 * x[n + i] * level.slopes[n + i];
  return level;
}

/// E_d = ½ vᵀM v + V(y) with M v + (h/2) ∇V(y) = p₀ and y = q₀ + (h/2) v. If w solves (M + (h²/4) V″(y)) w = p₀, then
/// ∂E_d/∂p₀ = w and ∂E_d/∂q₀ = ∇V(y) − (h/2) V″(y) w.
EnergyLevel energy_of_first_step(const text::SizedScene& scene, const double* x, double step) {
  if (!scene.has_constant_metric()) return energy_on_a_metric(scene, x, step);
  const std::size_t n = scene.coordinates;
  const double half = 0.5 * step, beta = half * half, none = 0;
  std::vector<double> guess(n), place(n), slope(n), p(n), v(n);
  scene.velocity(x + n, v.data());
  for (std::size_t i = 0; i < n; ++i) guess[i] = x[i] + half * v[i];
  Work work;
  PlaceMatrix matrix(scene);
  if (PlaceSolver(scene).solve(guess.data(), beta, none, place, slope, work) != StepStatus::ok ||
      !matrix.factor(place.data(), &beta, &none, PlaceMatrix::Curvature::of_each, work))
    return beside_constant(scene, energy_of_start(scene, x));
  EnergyLevel level{0, std::vector<double>(x, x + 2 * n)};
  for (std::size_t i = 0; i < n; ++i) p[i] = x[n + i] - half * slope[i];
  scene.velocity(p.data(), v.data());
  scene.potential_beside_constant().evaluate(place.data(), 0.0, &level.value);
  for (std::size_t i = 0; i < n; ++i) level.value += 0.5 * p[i] * v[i];
  double* const w = &level.slopes[n];
  matrix.solve(w);
  std::vector<Slope> along(n), moved(n);
  for (std::size_t i = 0; i < n; ++i) along[i] = Slope(place[i], {w[i]});
  scene.gradient.evaluate(along.data(), 0.0, moved.data());
  for (std::size_t i = 0; i < n; ++i) level.slopes[i] = slope[i] - half * moved[i].slope[0];
  return level;
}

}  // namespace least
