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

/// ½ vᵀg(q)v − V(q), with velocities in the places of momenta.
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
  } else if (form.kind == FormKind::lagrangian) {
    std::vector<Symbol> of_velocities = form.momenta;
    const std::vector<Symbol> hessian = form.hessian.written_out();
    of_velocities.insert(of_velocities.end(), hessian.begin(), hessian.end());
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
  // Drifts are symplectic where the matrix is symmetric to the last bit.
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      known[i][j] = 0.5 * (given[i * n + j] + given[j * n + i]);
      found[i][j] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
    }
}

Vec<compiled_coordinates> Formulas::velocities(const Vec<compiled_coordinates>& q, const Vec<compiled_coordinates>& p,
                                               double s, double t) const {
  constexpr int most_rounds = 100, most_halvings = 30;
  const std::size_t n = coordinates;
  Vec<compiled_coordinates> v{}, rest{};
  std::array<double, std::size_t(compiled_coordinates * (compiled_coordinates + 1))> all;
  Mat<compiled_coordinates> hessian{};
  // How far the momenta at v are from p; sets what a step needs.
  const auto look = [&](const Vec<compiled_coordinates>& at) {
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
      Vec<compiled_coordinates> other{};
      for (std::size_t i = 0; i < n; ++i) other[i] = share * (p[i] != 0 ? p[i] : 1);
      wrong = look(v = other);
      if (std::isfinite(wrong) && !singular_at(all)) break;
    }
  }
  // What is left is held against the momenta and the terms that cancel in them, here or where it began.
  const auto terms = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      sum += std::abs(p[i]);
      for (std::size_t j = 0; j < n; ++j) sum += std::abs(all[n + i * n + j] * v[j]);
    }
    return sum;
  };
  double size = terms();
  for (int round = 0; round < most_rounds && wrong > 0; ++round) {
    for (std::size_t i = 0; i < compiled_coordinates; ++i) {
      hessian[i].fill(0);
      hessian[i][i] = 1;
    }
    for (std::size_t i = 0; i < n; ++i) {
      rest[i] = p[i] - all[i];
      for (std::size_t j = 0; j < n; ++j) hessian[i][j] = all[n + i * n + j];
    }
    const auto step = LinearSolver<double>::solve(hessian, rest);
    Vec<compiled_coordinates> next = v;
    double now = wrong;
    for (int halving = 0; halving < most_halvings && !(now < wrong); ++halving) {
      for (std::size_t i = 0; i < n; ++i) next[i] = v[i] + std::exp2(-halving) * step[i];
      now = look(next);
    }
    if (!(now < wrong)) break;  // rounding is all that is left, or there is no solution
    v = next;
    wrong = now;
  }
  size = std::max(size, terms());
  if (wrong != 0 && !(wrong <= 1e-12 * size)) v.fill(std::numeric_limits<double>::quiet_NaN());
  return v;
}

LagrangianScene::Extended LagrangianScene::rates(const Extended& x, const Symbol& t) const {
  using Along = Dual<Symbol, 1>;  // the motion, but for v
  constexpr std::size_t action = 2 * dof, velocity = action + 1;
  const std::size_t n = coordinates();
  const auto moving = [](const Symbol& value, const Symbol& rate) {
    Along y(value);
    y.slope[0] = rate;
    return y;
  };
  std::array<Along, std::size_t(first_parameter)> y;
  for (std::size_t i = 0; i < n; ++i) {
    y[i] = moving(x[i], x[velocity + i]);
    y[first_momentum + i] = Along(x[velocity + i]);
  }
  y[action_variable] = Along(x[action]);
  std::array<Along, 2 * dof + 2> all;  // L, L_q, L_v, L_s
  Extended rate{};
  if (reads_action()) {
    formulas->all_of_lagrangian.evaluate(y.data(), moving(t, Symbol(1)), all.data());
    rate[action] = all[0].value;
    y[action_variable] = moving(x[action], rate[action]);
  }
  formulas->all_of_lagrangian.evaluate(y.data(), moving(t, Symbol(1)), all.data());
  const Symbol by_action = all[1 + 2 * n].value;
  std::vector<Symbol> matrix(n * n), right(n);
  std::array<Symbol, std::size_t(first_parameter)> plain;
  for (std::size_t i = 0; i < plain.size(); ++i) plain[i] = y[i].value;
  std::array<Symbol, std::size_t(dof + dof * dof)> momenta;
  formulas->momenta.evaluate(plain.data(), t, momenta.data());
  for (std::size_t i = 0; i < n; ++i) {
    rate[i] = x[velocity + i];
    rate[dof + i] = all[1 + i].value + by_action * x[dof + i];
    right[i] = rate[dof + i] - all[1 + n + i].slope[0];
    for (std::size_t j = 0; j < n; ++j) matrix[i * n + j] = momenta[n + i * n + j];
  }
  tape::eliminate(matrix, right);
  std::ranges::copy(right, rate.begin() + velocity);
  return rate;
}

}  // namespace least::text
