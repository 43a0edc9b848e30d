// What a run asks of a problem beyond its table: steps by a scheme with their tangents, and its equations of motion as
// something else than numbers. Made for each problem in core/catalogue/compiled.hpp.
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

  /// Of the state that the run carries, and of one that has what the motion needs and no more.
  virtual const ProblemTable& table() const = 0;
  virtual const ProblemTable& motion() const = 0;
  /// The scheme of a request bound to the problem at x: steps of the grid, or by the scheme's own clock up to `end`.
  virtual std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid,
                                           double end) const = 0;
  /// Of steps of the scheme of a request.
  virtual StepTangents tangents(const Request& request) const = 0;

  /// The equations of the motion, written on a tape: the rates of its variables, which are the components of
  /// the state and then `found` velocities that follow from momenta by iteration.
  virtual std::vector<tape::Index> write_equations(tape::Tape& tape) const = 0;
  virtual std::size_t found() const = 0;
  /// The variables of that tape at a state, and how they change along a direction u of the components.
  virtual void values_of(StateView x, double* values) const = 0;
  virtual void values_of(StateView x, const double* u, double* values, double* slopes) const = 0;

  /// What is steep in them; null where nothing is.
  virtual std::shared_ptr<const tape::SteepForces> steep_forces() const = 0;

  // States from here on have what the motion needs and no more.

  /// Of mechanics: q̇ of a state, and how it changes along a direction u of the components.
  virtual void velocity(StateView x, double* v) const = 0;
  virtual void velocity_slopes(StateView x, const double* u, double* slopes) const = 0;
  /// Whether the problem has the i-th component: others rest, where there is room for more than it has.
  virtual bool has_component(std::size_t i) const = 0;
  /// Whether there is a closed form of the motion from x.
  virtual bool has_closed_form(StateView x) const = 0;
  /// Of contact mechanics, from a full state: the energy at a later time, as far as the motion can be followed closely;
  /// else not a number.
  virtual double energy_after(StateView x, double t) const = 0;
};

/// Of a state of the run what the motion needs.
inline RunState moving_part(const RunBackend& backend, StateView x) {
  return {x.t, StateNumbers(x.numbers, x.numbers + backend.motion().traits.components)};
}

}  // namespace least
