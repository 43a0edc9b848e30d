// A scene as text of any size, in the form of a problem table.
#pragma once

#include <memory>

#include "core/catalogue/forward_table.hpp"
#include "core/run/backend.hpp"
#include "core/run/problem_table.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// traits_of returns the traits of such a scene with states that carry all components, or only those that the motion
/// needs.
ProblemTraits traits_of(const text::SizedScene& scene, bool all = true);

class SizedTable final : public ProblemTable {
 public:
  /// `forward` is the table of a problem of the catalogue that goes backward, else null.
  SizedTable(std::shared_ptr<const text::SizedScene> scene, const ProblemTraits& known,
             std::shared_ptr<const ForwardTable> forward)
      : ProblemTable(known), scene_(std::move(scene)), forward_(std::move(forward)) {}
  const text::SizedScene& scene() const { return *scene_; }

  RunState start(const std::vector<double>& variables, double t) const override;
  void rates(StateView x, double* rates) const override { rate().evaluate(x.numbers, x.t, rates); }
  void rates(StateView x, const double* u, double dt, double* rates, double* changes) const override;
  double energy_of(StateView x) const override { return energy_terms(x).total; }
  EnergyTerms energy_terms(StateView x) const override;
  void energy_terms(const StateRows& states, EnergyTerms* terms) const override;
  double mechanical_energy(StateView x) const override;
  double damping(double t) const override;
  double action_slope(double s, double t) const override {
    return traits.contact ? scene_->action_slope(s, t) : unknown;
  }
  double action_curvature() const override { return traits.quadratic_contact ? scene_->action_curvature : unknown; }
  double offset() const override { return scene_->offset; }
  double period() const override { return 0; }
  double stiffness_rate() const override { return unknown; }
  double frequency_squared(StateView x) const override {
    return forward_ ? forward_->at(x, [](const auto& of, StateView y) { return of.frequency_squared(y); }) : unknown;
  }
  bool reads_action() const override { return scene_->reads_action; }
  bool outside(StateView x) const override {
    return forward_ && forward_->at(x, [](const auto& of, StateView y) { return of.outside(y); });
  }
  double inside(StateView x) const override {
    return forward_ ? forward_->at(x, [](const auto& of, StateView y) { return of.inside(y); }) : unknown;
  }
  void sections(StateView, double*) const override {}
  void invariants(StateView x, double* values) const override { scene_->invariants.evaluate(x.numbers, x.t, values); }
  void invariants(const StateRows& states, double* values) const override;
  double quantity(StateView x, std::size_t i) const override {
    return forward_ ? forward_->at(x, [i](const auto& of, StateView y) { return of.quantity(y, i); }) : unknown;
  }
  double element(StateView x, std::size_t i) const override {
    return forward_ ? forward_->at(x, [i](const auto& of, StateView y) { return of.element(y, i); }) : unknown;
  }
  double entropy(StateView) const override { return unknown; }
  std::span<const std::string_view> moment_names() const override { return {}; }
  void moments(StateView, double*) const override {}
  double log_weight(StateView) const override { return unknown; }
  double log_rate(StateView) const override { return unknown; }
  double gravitational_parameter() const override { return forward_ ? forward_->gravitational_parameter() : unknown; }
  bool starts_series(StateView) const override { return false; }
  RunState series_state(double) const override { return {}; }

 private:
  const text::StateFormula& rate() const {
    return traits.components == scene_->components ? scene_->rate : scene_->motion();
  }
  /// reads_hamiltonian() tells whether the terms of the energy are found from the Hamiltonian.
  bool reads_hamiltonian() const { return traits.configuration_metric || (traits.general && traits.full); }
  /// energy_from returns the terms of the energy with V and H at x; V counts where there is a potential, H where
  /// reads_hamiltonian().
  EnergyTerms energy_from(StateView x, double potential, double hamiltonian) const;
  /// kinetic_by_masses returns p·M⁻¹p/2 for a constant metric.
  double kinetic_by_masses(StateView x) const;

  std::shared_ptr<const text::SizedScene> scene_;
  std::shared_ptr<const ForwardTable> forward_;
};

}  // namespace least
