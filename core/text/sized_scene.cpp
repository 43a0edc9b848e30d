#include "core/text/sized_scene.hpp"

#include <numeric>

#include "core/number/linear.hpp"
#include "core/tape/derivative.hpp"

namespace least::text {

bool SizedScene::has(const Form& form) {
  switch (form.kind) {
    case FormKind::separable:
    case FormKind::contact_linear:
    case FormKind::hamiltonian:
    case FormKind::flow:
      return true;
    default:
      return false;
  }
}

SizedScene::SizedScene(const Form& form, std::span<const double> parameters)
    : kind(form.kind),
      coordinates(form.coordinates),
      flow(form.kind == FormKind::flow),
      acting(form.kind == FormKind::contact_linear || (form.kind == FormKind::hamiltonian && form.reads_action)),
      reads_action(form.reads_action || form.kind == FormKind::contact_linear),
      constant_damping(form.constant_damping),
      autonomous(form.autonomous),
      keeps_energy(form.keeps_energy) {
  const std::size_t n = coordinates;
  components = flow ? n : 2 * n + (acting ? 1 : 0);
  equations.bound(most_equations);
  const auto variable = [&](std::size_t i) { return Symbol::variable(equations, i); };
  const Numbering& numbers = form.numbers;
  tape::Substitution fold(form.tape, equations, [&](int i) {
    if (i >= numbers.parameter) return Symbol(parameters[static_cast<std::size_t>(i - numbers.parameter)]);
    if (flow || i < numbers.momentum) return variable(static_cast<std::size_t>(i));
    return i == numbers.action ? variable(2 * n) : variable(n + static_cast<std::size_t>(i - numbers.momentum));
  });
  const auto folded = [&](const std::vector<Symbol>& all) {
    std::vector<Symbol> made;
    made.reserve(all.size());
    for (const Symbol& y : all) made.push_back(fold(y));
    return made;
  };
  const auto formula = [&](const std::vector<Symbol>& all) {
    std::vector<tape::Index> places;
    places.reserve(all.size());
    for (const Symbol& y : all) places.push_back(y.on(equations));
    return tape::Formula(equations, places);
  };
  const auto number = [](const Symbol& y) {
    return y.is_constant() ? y.constant() : std::numeric_limits<double>::quiet_NaN();
  };

  std::vector<Symbol> all(components);
  std::vector<int> places(n);
  std::iota(places.begin(), places.end(), 0);
  if (flow) {
    all = folded(form.rates);
  } else if (kind == FormKind::hamiltonian) {
    const Symbol h = fold(form.hamiltonian);
    for (std::size_t i = n; i <= 2 * n; ++i) places.push_back(static_cast<int>(i));
    const std::vector<Symbol> slopes = tape::gradient(equations, h, places);
    Symbol work = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = variable(n + i);
      all[i] = slopes[n + i];
      all[n + i] = acting ? -slopes[i] - p * slopes[2 * n] : -slopes[i];
      if (acting) work = i == 0 ? p * all[i] : work + p * all[i];
    }
    if (acting) all[2 * n] = work - h;
    hamiltonian = formula({h, slopes[2 * n]});
  } else {
    const Symbol v = fold(form.potential), alpha = fold(form.damping);
    const std::vector<Symbol> slopes = tape::gradient(equations, v, places);
    std::vector<double> second;
    if (form.full_mass)
      for (const Symbol& entry : form.hessian) second.push_back(number(fold(entry)));
    set_mass(folded(form.mass), second, !form.momenta.empty());
    Symbol twice_kinetic = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = variable(n + i);
      Symbol velocity = has_full_mass() ? Symbol(0) : Symbol(inverse_mass_[i]) * p;
      for (std::size_t j = 0; j < n && has_full_mass(); ++j)
        velocity = velocity + Symbol(inverse_matrix_[i * n + j]) * variable(n + j);
      all[i] = velocity;
      all[n + i] = acting ? -slopes[i] - alpha * p : -slopes[i];
      if (acting) twice_kinetic = i == 0 ? p * velocity : twice_kinetic + p * velocity;
    }
    if (acting) all[2 * n] = Symbol(0.5) * twice_kinetic - v - alpha * variable(2 * n);
    potential = formula({v});
    gradient = formula(slopes);
    damping = formula({alpha});
  }
  for (const Symbol& y : all) rates.push_back(y.on(equations));
  rate = tape::Formula(equations, rates);
  all = folded(form.invariants);
  all.resize(most_invariants);
  invariants = formula(all);
}

void SizedScene::set_mass(const std::vector<Symbol>& mass, const std::vector<double>& second, bool of_velocities) {
  const std::size_t n = coordinates;
  inverse_mass_.assign(n, 1);
  for (std::size_t i = 0; i < mass.size(); ++i)
    inverse_mass_[i] = mass[i].is_constant() ? 1 / mass[i].constant() : std::numeric_limits<double>::quiet_NaN();
  if (second.empty()) return;
  std::vector<double> inverse = second;
  if (of_velocities) detail::invert(n, inverse.data());
  inverse_matrix_.resize(n * n);
  for (std::size_t i = 0; i < n; ++i)  // drifts are symplectic where it is symmetric to the last bit
    for (std::size_t j = 0; j < n; ++j) inverse_matrix_[i * n + j] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
}

void SizedScene::velocity(const double* p, double* v) const {
  const std::size_t n = coordinates;
  for (std::size_t i = 0; i < n; ++i) {
    if (!has_full_mass()) {
      v[i] = inverse_mass_[i] * p[i];
      continue;
    }
    const double* const row = &inverse_matrix_[i * n];
    double sum = row[0] * p[0];
    for (std::size_t j = 1; j < n; ++j) sum = sum + row[j] * p[j];
    v[i] = sum;
  }
}

}  // namespace least::text
