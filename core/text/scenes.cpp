#include "core/text/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/tape/elimination.hpp"
#include "core/text/folding.hpp"
#include "core/text/lift.hpp"

namespace least::text {
namespace {

/// lagrangian_of returns ½ vᵀg(q)v − V(q), with velocities in the places of momenta.
Symbol lagrangian_of(const Form& form, Folding& fold) {
  Symbol l = -fold(form.potential);
  const std::size_t n = form.coordinates;
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& [j, entry] : form.metric.row(i)) {
      const Symbol g = fold(entry);
      l = l + 0.5 * (g * fold.variable(first_momentum + int(i))) * fold.variable(first_momentum + int(j));
    }
  return l;
}

}  // namespace

Formulas::Formulas(const Form& form, std::span<const double> parameters)
    : coordinates(form.coordinates), reads_action(form.reads_action) {
  Folding fold(form, parameters);
  std::vector<int> places, all;
  for (std::size_t i = 0; i < coordinates; ++i) places.push_back(static_cast<int>(i));
  all = places;
  invariants = fold.formula(form.invariants);
  if (form.kind == FormKind::flow) {
    rates = fold.formula(form.rates);
  } else if (form.kind == FormKind::hamiltonian) {
    for (std::size_t i = 0; i < coordinates; ++i) all.push_back(first_momentum + static_cast<int>(i));
    all.push_back(action_variable);
    hamiltonian = fold.formula(form.hamiltonian);
    slopes = fold.formula_of(fold.gradient(fold(form.hamiltonian), all));
    lift = Lift::of(form, parameters);
  } else {
    potential = fold.formula(form.potential);
    gradient = fold.formula_of(fold.gradient(fold(form.potential), places));
    damping = fold.formula(form.damping);
    metric = fold.formula(form.metric.written_out());
    if (form.kind == FormKind::metric) force = fold.formula_of(fold.gradient(lagrangian_of(form, fold), places));
    inverse_mass.fill(1);
    for (std::size_t i = 0; i < form.mass.size(); ++i) inverse_mass[i] = 1 / fold.number(form.mass[i]);
    if (form.full_mass) set_full_mass(fold.numbers(form.hessian.written_out()), !form.momenta.empty());
    if (form.constant_damping) alpha = fold.number(form.damping);
    gamma = fold.number(form.action_curvature);
    offset = fold.number(form.offset);
  }
}

void Formulas::set_full_mass(std::vector<double> given, bool of_velocities) {
  full_mass = true;
  const std::size_t n = coordinates;
  std::vector<double> inverse = given;
  detail::invert(n, inverse.data());
  Mat<compiled_coordinates>&known = of_velocities ? mass_matrix : inverse_mass_matrix,
  &found = of_velocities ? inverse_mass_matrix : mass_matrix;
  // Symmetrized exactly: drifts are symplectic only where the matrix is exactly symmetric.
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      known[i][j] = 0.5 * (given[i * n + j] + given[j * n + i]);
      found[i][j] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
    }
}

}  // namespace least::text
