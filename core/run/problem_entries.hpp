// The entries of a problem's table, made by the compiler from its description.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/exact/elements.hpp"
#include "core/phases.hpp"
#include "core/run/problem_table.hpp"

namespace least {

/// traits_of returns the traits of the problem P with states X.
template <class P, class X>
constexpr ProblemTraits traits_of() {
  ProblemTraits traits;
  traits.components = X::size;
  traits.numbers = numbers_in<X>;
  traits.moving = StateOf<P>::size;
  traits.acting = X::acting;
  traits.sloped = Sloped<X>;
  traits.full = std::is_same_v<X, FullRunState<P>>;
  traits.flow = Flow<P>;
  traits.potential = Potential<P>;
  traits.general = GeneralHamiltonian<P>;
  traits.conservative = Conservative<P>;
  traits.configuration_metric = ConfigurationMetric<P>;
  traits.split_flow = SplitFlow<P>;
  traits.contact = Contact<P>;
  traits.linear_contact = LinearContact<P>;
  traits.quadratic_contact = QuadraticContact<P>;
  traits.constant_damping = ConstantDamping<P>;
  traits.autonomous = Autonomous<P>;
  traits.has_energy = HasEnergy<P>;
  traits.keeps_energy = KeepsEnergy<P>;
  traits.has_frequency = HasFrequency<P>;
  traits.constant_frequency = ConstantFrequency<P>;
  traits.has_series = HasSeries<P>;
  if constexpr (!Flow<P>) traits.has_section = HasSection<P>;
  traits.oscillates = Oscillates<P>;
  traits.carries_slope = CarriesSlope<P>;
  traits.has_entropy = HasEntropy<P>;
  if constexpr (!Flow<P>) traits.dof = P::dof;
  traits.sections = std::tuple_size_v<decltype(sections(P{}, X{}))>;
  if constexpr (HasInvariants<P>) traits.invariants = std::tuple_size_v<decltype(invariants_at(P{}, StateOf<P>{}))>;
  if constexpr (HasQuantities<P>) traits.quantities = std::tuple_size_v<decltype(P{}.quantities(X{}.y, 0.0))>;
  if constexpr (TwoBody<P>) traits.elements = two_body::elements_in<P::dof>;
  if constexpr (HasMoments<P>) traits.moments = P::moment_names.size();
  if constexpr (HasSeries<P>) traits.series_until = P::series_until;
  if constexpr (requires { P::careful_step; }) traits.careful_step = P::careful_step;
  return traits;
}

template <class P, class X>
class ProblemEntries : public ProblemTable {
 public:
  static constexpr ProblemTraits known = traits_of<P, X>();

  explicit ProblemEntries(const P& problem) : ProblemTable(known), problem_(problem) {}
  const P& problem() const { return problem_; }

  RunState start(const std::vector<double>& variables, double t) const final {
    return run_state(start_of<X>(problem_, variables, t));
  }
  void rates(StateView x, double* rates) const final { write_numbers(derivative(problem_, state(x)), rates); }
  void rates(StateView x, const double* u, double dt, double* rates, double* changes) const final {
    using T = typename X::Number;
    using D = Dual<T, 1>;
    const X direction = state({0, u});
    auto moved = convert<D, D>(state(x));
    moved.t.slope[0] = T(dt);
    for (std::size_t i = 0; i < X::size; ++i) moved[i].slope[0] = direction[i];
    const auto dual = derivative(problem_, moved);
    X value, change;
    for (std::size_t i = 0; i < X::size; ++i) {
      value[i] = dual[i].value;
      change[i] = dual[i].slope[0];
    }
    write_numbers(value, rates);
    write_numbers(change, changes);
  }

  double energy_of(StateView x) const final {
    if constexpr (known.says_energy()) return least::energy_of(problem_, plain(state(x)));
    return unknown;
  }
  EnergyTerms energy_terms(StateView x) const final { return terms_at(state(x)); }
  void energy_terms(const StateRows& states, EnergyTerms* terms) const final {
    for (std::size_t i = 0; i < states.count; ++i) terms[i] = terms_at(state(states[i]));
  }
  double mechanical_energy(StateView view) const final {
    const X x = state(view);
    if constexpr (Potential<P>) return least::mechanical_energy(problem_, x.q, x.p, phase(problem_, x.t));
    return unknown;
  }

  double damping(double t) const final {
    if constexpr (LinearContact<P>) return least::damping(problem_, phase(problem_, t));
    return unknown;
  }
  double action_slope(double s, double t) const final {
    if constexpr (Contact<P>) return least::action_slope(problem_, s, phase(problem_, t));
    return unknown;
  }
  double action_curvature() const final {
    if constexpr (QuadraticContact<P>) return problem_.action_curvature();
    return unknown;
  }
  double offset() const final {
    if constexpr (QuadraticContact<P>) return problem_.offset();
    return 0;
  }
  double period() const final {
    if constexpr (Periodic<P>) return problem_.period();
    return 0;
  }
  double stiffness_rate() const final {
    if constexpr (requires { problem_.stiffness_rate(); }) return problem_.stiffness_rate();
    return unknown;
  }
  double frequency_squared(StateView x) const final {
    if constexpr (HasFrequency<P>) return problem_.frequency_squared(position(plain(state(x))));
    return unknown;
  }
  bool reads_action() const final {
    if constexpr (GeneralHamiltonian<P>) return problem_.reads_action();
    return Contact<P>;
  }

  bool outside(StateView x) const final { return least::outside(problem_, state(x)); }
  double inside(StateView x) const final {
    if constexpr (HasDomain<P>) return problem_.inside(position(state(x)));
    return unknown;
  }

  void sections(StateView x, double* values) const final {
    std::ranges::copy(least::sections(problem_, state(x)), values);
  }
  void invariants(StateView x, double* values) const final {
    if constexpr (HasInvariants<P>) std::ranges::copy(invariants_at(problem_, plain(state(x))), values);
  }
  void invariants([[maybe_unused]] const StateRows& states, [[maybe_unused]] double* values) const final {
    if constexpr (HasInvariants<P>)
      for (std::size_t i = 0; i < states.count; ++i)
        values = std::ranges::copy(invariants_at(problem_, plain(state(states[i]))), values).out;
  }
  double quantity(StateView x, std::size_t index) const final {
    if constexpr (HasQuantities<P>) return problem_.quantities(plain(state(x)).y, x.t)[index];
    return unknown;
  }
  double element(StateView view, std::size_t index) const final {
    const X x = state(view);
    if constexpr (TwoBody<P>)
      return two_body::element(two_body::elements(x.q, x.p, problem_.gravitational_parameter()), index);
    return unknown;
  }
  double entropy(StateView x) const final {
    if constexpr (HasEntropy<P>) return problem_.entropy(plain(state(x)).y);
    return unknown;
  }
  std::span<const std::string_view> moment_names() const final {
    if constexpr (HasMoments<P>) return P::moment_names;
    return {};
  }
  void moments(StateView x, double* values) const final {
    if constexpr (HasMoments<P>) std::ranges::copy(problem_.moments(plain(state(x)).y), values);
  }
  double log_weight(StateView x) const final {
    if constexpr (HasMoments<P>) return problem_.log_weight(plain(state(x)).y);
    return unknown;
  }
  double log_rate(StateView x) const final {
    if constexpr (HasMoments<P>) return problem_.log_rate(plain(state(x)).y);
    return unknown;
  }
  double gravitational_parameter() const final {
    if constexpr (TwoBody<P>) return problem_.gravitational_parameter();
    return unknown;
  }

  bool starts_series(StateView x) const final { return least::starts_series(problem_, state(x)); }
  RunState series_state([[maybe_unused]] double t) const final {
    if constexpr (HasSeries<P>) return run_state(least::series_state<X>(problem_, t));
    return {};
  }

 protected:
  static X state(StateView x) { return state_from<X>(x); }

 private:
  EnergyTerms terms_at([[maybe_unused]] const X& x) const {
    EnergyTerms terms{unknown, unknown, unknown, unknown};
    if constexpr (Potential<P>) {  // H as the sum of its parts, so that none is computed twice
      const auto f = phase(problem_, x.t);
      terms.kinetic = 0.5 * dot(x.p, velocity(problem_, x.q, x.p));
      terms.potential = problem_.potential(x.q, f);
      if constexpr (!Contact<P>) terms.total = terms.kinetic + terms.potential;
      if constexpr (Contact<P> && X::acting) {
        terms.total = terms.kinetic + terms.potential + least::action_energy(problem_, x.action.s, f);
        terms.action_slope = least::action_slope(problem_, x.action.s, f);
      }
    } else if constexpr (known.says_energy()) {
      terms.total = least::energy(problem_, plain(x));
    }
    return terms;
  }

  const P problem_;
};

}  // namespace least
