// SizedScene's members that work with Lagrangians and with metrics that depend on q.
#include <algorithm>
#include <numeric>

#include "core/number/linear.hpp"
#include "core/tape/derivative.hpp"
#include "core/tape/elimination.hpp"
#include "core/text/sized_scene.hpp"

namespace least::text {
namespace {

/// eliminate solves A x = b block by block, x replacing b; the blocks number the `entries` of A from 1 on.
void eliminate(const std::vector<BlockMatrix::Block>& blocks, const std::vector<Symbol>& entries, Symbol* b) {
  for (const BlockMatrix::Block& block : blocks) {
    std::vector<Symbol> matrix, right;
    for (const double which : block.numbers)
      matrix.push_back(which == 0 ? Symbol(0) : entries[static_cast<std::size_t>(which) - 1]);
    for (const std::size_t i : block.of) right.push_back(b[i]);
    tape::eliminate(matrix, right);
    for (std::size_t i = 0; i < right.size(); ++i) b[block.of[i]] = right[i];
  }
}

}  // namespace

/// q̇ = g⁻¹p, and ṗ = ∂L/∂q at that velocity.
std::vector<Symbol> SizedScene::set_metric(const Form& form, tape::Substitution& fold) {
  const std::size_t n = coordinates;
  const auto variable = [&](std::size_t i) { return Symbol::variable(equations, i); };
  std::vector<int> places(n);
  std::iota(places.begin(), places.end(), 0);
  const Symbol v = fold(form.potential);
  Symbol kinetic = 0;
  std::vector<Symbol> entries;
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& [j, entry] : form.metric.row(i)) {
      const bool known = j < i;  // the metric is symmetric
      entries.push_back(fold(known ? form.metric.at(j, i) : entry));
      if (!known) kinetic = kinetic + ((i == j ? 0.5 : 1.0) * (entries.back() * variable(n + i))) * variable(n + j);
    }
  const tape::Formula by_place = formula_of(tape::gradient(equations, kinetic, places));
  const std::vector<Symbol> slopes = tape::gradient(equations, v, places);
  std::vector<Symbol> all_slopes = with_slopes(kinetic - v);
  lagrangian = formula_of(all_slopes);
  all_slopes.erase(all_slopes.begin() + 1, all_slopes.begin() + static_cast<std::ptrdiff_t>(1 + n));
  all_slopes.pop_back();
  lowered = formula_of(all_slopes);
  potential = formula_of({v});
  gradient = formula_of(slopes);
  const auto with = [&](const std::vector<Symbol>& velocity) {  // q̇, ṗ, H for this velocity
    std::vector<Symbol> all = velocity, at(2 * n);
    all.resize(2 * n);
    Symbol twice_kinetic = 0;
    for (std::size_t i = 0; i < n; ++i) {
      at[i] = variable(i);
      at[n + i] = velocity[i];
      twice_kinetic = i == 0 ? variable(n) * velocity[0] : twice_kinetic + variable(n + i) * velocity[i];
    }
    by_place.evaluate(at.data(), Symbol(0), all.data() + n);
    for (std::size_t i = 0; i < n; ++i) all[n + i] = all[n + i] - slopes[i];
    all.push_back(Symbol(0.5) * twice_kinetic + v);
    return all;
  };
  std::vector<Symbol> velocity, found;
  for (std::size_t i = 0; i < n; ++i) {
    velocity.push_back(variable(n + i));
    found.push_back(variable(components + i));
  }
  const auto blocks = Velocities::blocks_of(form.metric);
  eliminate(blocks, entries, velocity.data());
  std::vector<Symbol> all = with(velocity);
  raised = {formula_of(velocity), components, nullptr};
  hamiltonian = {formula_of({all.back(), Symbol(0)}), components, nullptr};
  constexpr std::size_t few = 4;
  const auto is_small = [](const BlockMatrix::Block& block) { return block.of.size() <= few; };
  if (!forced && !std::ranges::all_of(blocks, is_small)) {
    std::vector<Symbol> momenta(n, Symbol(0));
    for (std::size_t i = 0, next = 0; i < n; ++i)
      for (const auto& entry : form.metric.row(i))
        momenta[i] = momenta[i] + entries[next++] * variable(n + entry.column);
    const tape::Formula of_velocities = formula_of(momenta);
    momenta.insert(momenta.end(), entries.begin(), entries.end());
    const auto solved = std::make_shared<const Velocities>(form.metric, of_velocities, formula_of(momenta), true);
    raised = {formula_of(found), components, solved};
    std::vector<Symbol> of_found = with(found);
    hamiltonian = {formula_of({of_found.back(), Symbol(0)}), components, solved};
    of_found.pop_back();
    rate = {formula_of(of_found), components, solved};
  }
  all.pop_back();
  return all;
}

std::vector<Symbol> SizedScene::with_slopes(const Symbol& value) {
  std::vector<int> places(2 * coordinates + 1);
  std::iota(places.begin(), places.end(), 0);
  std::vector<Symbol> all = tape::gradient(equations, value, places);
  all.insert(all.begin(), value);
  return all;
}

/// Herglotz's equations d(∂L/∂v)/dt = ∂L/∂q + ∂L/∂s ∂L/∂v, solved for v̇.
std::vector<Symbol> SizedScene::set_lagrangian(const Form& form, tape::Substitution& fold) {
  using Along = Dual<Symbol, 1>;  // a derivative along the motion of q, s and t, with v fixed
  const std::size_t n = coordinates;
  const std::vector<Symbol> slopes = with_slopes(fold(form.lagrangian));
  lagrangian = formula_of(slopes);
  std::vector<Symbol> momenta(slopes.begin() + static_cast<std::ptrdiff_t>(1 + n), slopes.end() - 1),
      with_hessian = momenta;
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& entry : form.hessian.row(i)) with_hessian.push_back(fold(entry.value));
  const tape::Formula hessian = formula_of(with_hessian);
  velocities = std::make_shared<const Velocities>(form.hessian, formula_of(momenta), hessian);

  const auto v = [&](std::size_t i) { return Symbol::variable(equations, components + i); };
  const auto p = [&](std::size_t i) { return Symbol::variable(equations, n + i); };
  const auto moving_at = [](const Symbol& value, const Symbol& change) {
    Along y(value);
    y.slope[0] = change;
    return y;
  };
  const Along t = moving_at(Symbol::time(equations), Symbol(1));
  std::vector<Along> y(2 * n + 1), l(2 * n + 2);  // (q, v, s); L, L_q, L_v, L_s
  for (std::size_t i = 0; i < n; ++i) {
    y[i] = moving_at(Symbol::variable(equations, i), v(i));
    y[n + i] = Along(v(i));
  }
  if (acting) {
    y[2 * n] = Along(Symbol::variable(equations, 2 * n));
    lagrangian.evaluate(y.data(), t, l.data());
    y[2 * n].slope[0] = l[0].value;
  }
  lagrangian.evaluate(y.data(), t, l.data());
  const Symbol by_s = l[2 * n + 1].value;
  std::vector<Symbol> all(components + n), plain, entries(with_hessian.size());
  for (const Along& number : y) plain.push_back(number.value);
  hessian.evaluate(plain.data(), t.value, entries.data());
  Symbol h = -l[0].value;
  for (std::size_t i = 0; i < n; ++i) {
    all[i] = v(i);
    all[n + i] = l[1 + i].value + by_s * p(i);
    h = h + p(i) * v(i);
  }
  if (acting) all[2 * n] = l[0].value;
  entries.erase(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(n));
  for (std::size_t i = 0; i < n; ++i) all[components + i] = all[n + i] - l[1 + n + i].slope[0];
  eliminate(velocities->blocks(), entries, &all[components]);
  hamiltonian = {formula_of({h, -by_s}), components, velocities};
  return all;
}

std::vector<Symbol> SizedScene::slopes_of_lagrangian(const Symbol& v_of_place, const Symbol& of_action) {
  const std::size_t n = coordinates;
  std::vector<double> mass(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    if (!has_full_mass()) mass[i * n + i] = inverse_mass_[i];
    for (std::size_t k = 0; has_full_mass() && k < inverse_matrix_[i].size(); ++k)
      mass[i * n + inverse_matrix_[i][k].first] = inverse_matrix_[i][k].second;
  }
  detail::invert(n, mass.data());
  const auto v = [&](std::size_t i) { return Symbol::variable(equations, n + i); };
  Symbol l = -v_of_place - of_action;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (mass[i * n + j] != 0) l = l + Symbol(0.5 * mass[i * n + j]) * (v(i) * v(j));
  return with_slopes(l);
}

}  // namespace least::text
