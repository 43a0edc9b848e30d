// What a run needs of a problem beyond its table: steps of a scheme with their tangents, and its equations of motion in
// other forms than numbers. It is made for each problem in core/catalogue/compiled.hpp.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/run/problem_table.hpp"
#include "core/run/tangent_map.hpp"
#include "core/tape/tape.hpp"

namespace least {

class Integrator;
struct Grid;
struct Request;
namespace tape {
class SteepForces;
}

class RunBackend {
 public:
  virtual ~RunBackend() = default;

  /// table() works on states that the run carries, motion() on states with only those components that the motion needs.
  virtual const ProblemTable& table() const = 0;
  virtual const ProblemTable& motion() const = 0;
  /// bind returns the scheme of a request, bound to the problem at x: with the steps of the grid, or with the scheme's
  /// own clock up to `end`.
  virtual std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid,
                                           double end) const = 0;
  /// tangents returns the tangents of the steps of a request's scheme.
  virtual StepTangents tangents(const Request& request) const = 0;

  /// write_equations writes the equations of motion on a tape and returns the rates of its variables. These are the
  /// components of the state, then found() velocities that follow from the momenta by iteration.
  virtual std::vector<tape::Index> write_equations(tape::Tape& tape) const = 0;
  virtual std::size_t found() const = 0;
  /// values_of writes the variables of that tape at a state, and their derivatives along a direction u of the
  /// components.
  virtual void values_of(StateView x, double* values) const = 0;
  virtual void values_of(StateView x, const double* u, double* values, double* slopes) const = 0;

  /// steep_forces returns the steep functions in these equations, null where there are none.
  virtual std::shared_ptr<const tape::SteepForces> steep_forces() const = 0;

  // States from here on have only those components that the motion needs.

  /// For mechanics: velocity writes q̇ at a state, velocity_slopes its derivative along a direction u of the
  /// components.
  virtual void velocity(StateView x, double* v) const = 0;
  virtual void velocity_slopes(StateView x, const double* u, double* slopes) const = 0;
  /// Whether the problem has component i; components of coordinates that a scene does not have stay constant.
  virtual bool has_component(std::size_t i) const = 0;
  /// Whether the motion from x is known in closed form.
  virtual bool has_closed_form(StateView x) const = 0;
  /// For contact mechanics: the energy at the later time t of the motion from the full state x; NaN where the motion
  /// cannot be followed accurately as far as that.
  virtual double energy_after(StateView x, double t) const = 0;
};

/// moving_part returns the components of a run's state that the motion needs.
inline RunState moving_part(const RunBackend& backend, StateView x) {
  return {x.t, StateNumbers(x.numbers, x.numbers + backend.motion().traits.components)};
}

}  // namespace least
