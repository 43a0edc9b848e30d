#include "core/text/scenes.hpp"

#include <cmath>
#include <limits>

#include "core/text/folding.hpp"

namespace least::text {
Formulas::Formulas(const Form& form, std::span<const double> parameters)
    : coordinates(form.coordinates), reads_action(form.reads_action) {
  Folding fold(form.tape, parameters);
  std::vector<int> places, all;
  for (std::size_t i = 0; i < coordinates; ++i) places.push_back(static_cast<int>(i));
  all = places;
  invariants = fold.formula(form.invariants);
  if (form.kind == FormKind::flow) {
    rates = fold.formula(form.rates);
  } else if (form.kind == FormKind::lagrangian) {
    std::vector<Symbol> of_velocities = form.momenta;
    of_velocities.insert(of_velocities.end(), form.hessian.begin(), form.hessian.end());
    momenta = fold.formula(of_velocities);
    all.push_back(action_variable);
    const Symbol l = fold(form.lagrangian);
    std::vector<Symbol> with_slopes = fold.gradient(l, all);
    with_slopes.insert(with_slopes.begin(), l);
    lagrangian = fold.formula_of(with_slopes);
    for (std::size_t i = 0; i < coordinates; ++i) all.insert(all.end() - 1, first_momentum + static_cast<int>(i));
    with_slopes = fold.gradient(l, all);
    with_slopes.insert(with_slopes.begin(), l);
    all_of_lagrangian = fold.formula_of(with_slopes);
  } else if (form.kind == FormKind::hamiltonian) {
    for (std::size_t i = 0; i < coordinates; ++i) all.push_back(first_momentum + static_cast<int>(i));
    all.push_back(action_variable);
    hamiltonian = fold.formula(form.hamiltonian);
    slopes = fold.formula_of(fold.gradient(fold(form.hamiltonian), all));
  } else {
    potential = fold.formula(form.potential);
    gradient = fold.formula_of(fold.gradient(fold(form.potential), places));
    damping = fold.formula(form.damping);
    metric = fold.formula(form.metric);
    inverse_mass.fill(1);
    for (std::size_t i = 0; i < form.mass.size(); ++i) inverse_mass[i] = 1 / fold.number(form.mass[i]);
    if (form.constant_damping) alpha = fold.number(form.damping);
    gamma = fold.number(form.action_curvature);
    offset = fold.number(form.offset);
  }
}

Vec<most_coordinates> Formulas::velocities(const Vec<most_coordinates>& q, const Vec<most_coordinates>& p, double s,
                                           double t) const {
  constexpr int most_rounds = 100, most_halvings = 30;
  const std::size_t n = coordinates;
  Vec<most_coordinates> v{}, rest{};
  std::array<double, std::size_t(most_coordinates * (most_coordinates + 1))> all;
  Mat<most_coordinates> hessian{};
  double size = 0;
  for (std::size_t i = 0; i < n; ++i) size += std::abs(p[i]);
  // How far the momenta at v are from p; sets what a step needs.
  const auto look = [&](const Vec<most_coordinates>& at) {
    momenta.evaluate(joined(q, at, s).data(), t, all.data());
    double wrong = 0;
    for (std::size_t i = 0; i < n; ++i) wrong += std::abs(p[i] - all[i]);
    return wrong;
  };
  const auto singular_at = [&](const auto& at) {
    for (std::size_t i = 0; i < n; ++i)
      if (!(std::abs(at[n + i * n + i]) > 0)) return true;
    return false;
  };
  // From rest; where nothing leads away from there, from the momenta themselves and from one to either side.
  double wrong = look(v);
  const double starts[] = {1, -1};
  if (!std::isfinite(wrong) || singular_at(all)) {
    for (const double share : starts) {
      Vec<most_coordinates> other{};
      for (std::size_t i = 0; i < n; ++i) other[i] = share * (p[i] != 0 ? p[i] : 1);
      wrong = look(v = other);
      if (std::isfinite(wrong) && !singular_at(all)) break;
    }
  }
  for (int round = 0; round < most_rounds && wrong > 0; ++round) {
    for (std::size_t i = 0; i < most_coordinates; ++i) {
      hessian[i].fill(0);
      hessian[i][i] = 1;
    }
    for (std::size_t i = 0; i < n; ++i) {
      rest[i] = p[i] - all[i];
      for (std::size_t j = 0; j < n; ++j) hessian[i][j] = all[n + i * n + j];
    }
    const auto step = LinearSolver<double>::solve(hessian, rest);
    Vec<most_coordinates> next = v;
    double now = wrong;
    for (int halving = 0; halving < most_halvings && !(now < wrong); ++halving) {
      for (std::size_t i = 0; i < n; ++i) next[i] = v[i] + std::exp2(-halving) * step[i];
      now = look(next);
    }
    if (!(now < wrong)) break;  // rounding is all that is left, or there is no solution
    v = next;
    wrong = now;
  }
  if (!(wrong <= 1e-12 * (1 + size))) v.fill(std::numeric_limits<double>::quiet_NaN());
  return v;
}

}  // namespace least::text
