#include "core/catalogue/sized_table.hpp"

namespace least {

ProblemTraits traits_of(const text::SizedScene& scene, bool all) {
  using text::FormKind;
  ProblemTraits traits;
  traits.components = traits.numbers = all ? scene.components : scene.moving;
  traits.moving = scene.moving;
  traits.forced = scene.forced && all;
  traits.dof = scene.flow ? 0 : scene.coordinates;
  traits.acting = scene.acting && (all || scene.components == scene.moving);
  traits.full = traits.components == scene.components;
  traits.flow = scene.flow;
  traits.general_lagrangian = scene.kind == FormKind::lagrangian;
  traits.general = scene.kind == FormKind::hamiltonian || traits.general_lagrangian;
  traits.potential = !traits.flow && !traits.general;
  traits.configuration_metric = scene.kind == FormKind::metric;
  traits.linear_contact = scene.kind == FormKind::contact_linear;
  traits.quadratic_contact = scene.is_quadratic();
  traits.contact = traits.linear_contact || traits.quadratic_contact;
  traits.conservative = traits.potential && !traits.contact && !scene.forced;
  traits.constant_damping = scene.constant_damping;
  traits.autonomous = scene.autonomous;
  traits.has_energy = !traits.flow;
  traits.keeps_energy = scene.keeps_energy;
  traits.invariants = text::most_invariants;
  return traits;
}

RunState SizedTable::start(const std::vector<double>& variables, double t) const {
  RunState x{t, StateNumbers(traits.components)};  // forces have done no work yet
  std::copy_n(variables.begin(), traits.components - (traits.forced ? 1 : 0), x.numbers.begin());
  return x;
}

void SizedTable::rates(StateView x, const double* u, double dt, double* rates, double* changes) const {
  thread_local std::vector<Slope> state, all;
  const std::size_t size = traits.components;
  state.resize(size);
  all.resize(size);
  for (std::size_t i = 0; i < size; ++i) state[i] = {x[i], {u[i]}};
  rate().evaluate(state.data(), Slope{x.t, {dt}}, all.data());
  for (std::size_t i = 0; i < size; ++i) {
    rates[i] = all[i].value;
    changes[i] = all[i].slope[0];
  }
}

double SizedTable::kinetic_by_masses(StateView x) const {
  thread_local std::vector<double> v;
  const std::size_t n = scene_->coordinates;
  const double* const p = x.numbers + n;
  v.resize(n);
  scene_->velocity(p, v.data());
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum = i == 0 ? p[0] * v[0] : sum + p[i] * v[i];
  return 0.5 * sum;
}

EnergyTerms SizedTable::energy_from(StateView x, double potential, double hamiltonian) const {
  EnergyTerms terms{unknown, unknown, unknown, unknown};
  if (traits.flow) {
    if (forward_) terms = forward_->at(x, [](const auto& of, StateView y) { return of.energy_terms(y); });
  } else if (traits.potential) {
    terms.kinetic = traits.configuration_metric ? hamiltonian - potential : kinetic_by_masses(x);
    terms.potential = potential;
    if (!traits.contact) terms.total = terms.kinetic + terms.potential;
    if (traits.contact && traits.acting) {
      const double s = x[2 * traits.dof];
      terms.action_slope = action_slope(s, x.t);
      terms.total = terms.kinetic + terms.potential + scene_->action_energy(s, x.t);
    }
  } else if (reads_hamiltonian()) {
    terms.total = hamiltonian;
  }
  return terms;
}

EnergyTerms SizedTable::energy_terms(StateView x) const {
  double potential = unknown, hamiltonian[2] = {unknown, unknown};
  if (traits.potential) scene_->potential.evaluate(x.numbers, x.t, &potential);
  if (reads_hamiltonian()) scene_->hamiltonian.evaluate(x.numbers, x.t, hamiltonian);
  return energy_from(x, potential, hamiltonian[0]);
}

void SizedTable::energy_terms(const StateRows& states, EnergyTerms* terms) const {
  thread_local std::vector<double> potentials, hamiltonians;
  potentials.assign(states.count, unknown);
  hamiltonians.assign(2 * states.count, unknown);
  if (traits.potential) scene_->potential.evaluate_rows(states.first, states.width, states.count, potentials.data());
  if (reads_hamiltonian())
    scene_->hamiltonian.evaluate_rows(states.first, states.width, states.count, hamiltonians.data());
  for (std::size_t i = 0; i < states.count; ++i) terms[i] = energy_from(states[i], potentials[i], hamiltonians[2 * i]);
}

double SizedTable::mechanical_energy(StateView x) const {
  const EnergyTerms terms = energy_terms(x);
  return terms.kinetic + terms.potential;
}

double SizedTable::damping(double t) const {
  if (!traits.linear_contact) return unknown;
  return scene_->damping_at(t);
}

void SizedTable::invariants(const StateRows& states, double* values) const {
  scene_->invariants.evaluate_rows(states.first, states.width, states.count, values);
}

}  // namespace least
