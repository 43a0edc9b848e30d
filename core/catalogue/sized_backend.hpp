// The RunBackend of a scene as text of any size, and the schemes that run it.
#pragma once

#include <memory>
#include <vector>

#include "core/catalogue/sized_table.hpp"
#include "core/run/integrator.hpp"

namespace least {

/// schemes_of returns the indices of the schemes that run a scene.
std::vector<std::size_t> schemes_of(const text::SizedScene& scene);

class SizedBackend final : public RunBackend {
 public:
  /// `all`: states of the run carry everything that can be asked for, as s where the motion does not depend on it.
  /// `forward`: the table of a problem of the catalogue that goes backward.
  explicit SizedBackend(std::shared_ptr<const text::SizedScene> scene, bool all = true,
                        const std::shared_ptr<const ForwardTable>& forward = nullptr)
      : traits_(traits_of(*scene, all)),
        motion_traits_(traits_of(*scene, false)),
        table_(scene, traits_, forward),
        motion_(std::move(scene), motion_traits_, forward) {
    if (!forward) return;
    forward->add_to(traits_);
    forward->add_to(motion_traits_);
  }

  const ProblemTable& table() const override { return table_; }
  const ProblemTable& motion() const override { return motion_; }
  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid,
                                   double end) const override;
  /// Tangents of schemes of equal steps, except with forces, and of schemes that choose their steps by an energy level.
  StepTangents tangents(const Request& request) const override;
  std::vector<tape::Index> write_equations(tape::Tape& tape) const override;
  std::size_t found() const override { return scene().found(); }
  void values_of(StateView x, double* values) const override;
  void values_of(StateView x, const double* u, double* values, double* slopes) const override;
  std::shared_ptr<const tape::SteepForces> steep_forces() const override;
  void velocity(StateView x, double* v) const override;
  void velocity_slopes(StateView x, const double* u, double* slopes) const override;
  bool has_component(std::size_t i) const override { return i < traits_.moving; }
  bool has_closed_form(StateView) const override { return false; }
  double energy_after(StateView x, double t) const override;

 private:
  const text::SizedScene& scene() const { return table_.scene(); }

  ProblemTraits traits_, motion_traits_;
  SizedTable table_, motion_;
};

}  // namespace least
