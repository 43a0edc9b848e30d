// A problem with the steps of a scheme that was found in it; everything else is passed on to the problem.
#pragma once

#include <memory>
#include <utility>

#include "core/catalogue/found_schemes.hpp"
#include "core/run/integrator.hpp"

namespace least {

class FoundBackend final : public RunBackend {
 public:
  FoundBackend(std::unique_ptr<const RunBackend> problem, std::shared_ptr<const Found> found)
      : problem_(std::move(problem)), found_(std::move(found)) {}

  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid,
                                   double end) const override {
    return found_->bind(*problem_, request, x, grid, end);
  }
  StepTangents tangents(const Request& request) const override { return found_->tangents(*problem_, request); }

  const ProblemTable& table() const override { return problem_->table(); }
  const ProblemTable& motion() const override { return problem_->motion(); }
  std::vector<tape::Index> write_equations(tape::Tape& tape) const override { return problem_->write_equations(tape); }
  std::size_t found() const override { return problem_->found(); }
  void values_of(StateView x, double* values) const override { problem_->values_of(x, values); }
  void values_of(StateView x, const double* u, double* values, double* slopes) const override {
    problem_->values_of(x, u, values, slopes);
  }
  std::shared_ptr<const tape::SteepForces> steep_forces() const override { return problem_->steep_forces(); }
  void velocity(StateView x, double* v) const override { problem_->velocity(x, v); }
  void velocity_slopes(StateView x, const double* u, double* slopes) const override {
    problem_->velocity_slopes(x, u, slopes);
  }
  bool has_component(std::size_t i) const override { return problem_->has_component(i); }
  bool has_closed_form(StateView x) const override { return problem_->has_closed_form(x); }
  double energy_after(StateView x, double t) const override { return problem_->energy_after(x, t); }

 private:
  std::unique_ptr<const RunBackend> problem_;
  std::shared_ptr<const Found> found_;
};

}  // namespace least
