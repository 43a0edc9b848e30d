// The structure a step keeps, measured by its map and the derivatives of that as numbers: the defect MᵀJM − J of the
// tangent map M where the scene is conservative, J = (0 I; −I 0), and where it has a contact form η = ds − p·dq the
// defect of φ*η = λη. Zero to round-off for a symplectic, for a contact scheme. Sources: Hairer, Lubich, Wanner 2006,
// VI.2; Vermeeren, Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 2.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "core/run/run_state.hpp"
#include "core/scheme.hpp"

namespace least {

/// From one state to another, both with s wherever the scene has one; of an extended space the time is the last of the
/// coordinates, and with it goes a momentum.
struct TangentMap {
  std::size_t dof = 0;    ///< of the space
  RunState from, to;      ///< their components: q, p, and s where there is one
  std::vector<double> m;  ///< the derivative of the i-th component by the j-th stands at i·size + j
  bool extended = false;

  std::size_t size() const { return from.size(); }
  double slope(std::size_t i, std::size_t j) const { return m[i * size() + j]; }
};

/// Where a step leads, and how that changes along one direction. A scheme that sets its own clock reaches states that
/// lie near each other at different times.
struct ChangeOfStep {
  RunState to;
  StateNumbers change;
  double longer = 0;      ///< by how much the step takes more time
  ActiveMethod course{};  ///< of a hybrid: how the step was taken
};

/// Tangents of the steps of a run, whichever state it carries: they are of the full one. Empty where the scheme has
/// none.
struct StepTangents {
  /// Of the step from x that follows one which was taken in the way `before`, where x changes by u, the time by dt and
  /// the energy level of the run by `level`; false where it fails.
  std::function<bool(const RunState& x, const ActiveMethod& before, const StateNumbers& u, double dt, double level,
                     ChangeOfStep& to)>
      along;
  /// Asked before each direction; false gives up, as a step that fails does.
  using KeepGoing = std::function<bool()>;
  /// Along all directions, at equal times and levels.
  std::function<bool(const RunState& x, const KeepGoing& keep_going, TangentMap& map)> plain;
  /// The same on the extended space, for schemes whose steps are contact maps there.
  std::function<bool(const RunState& x, const KeepGoing& keep_going, TangentMap& map)> extended;
  std::vector<double> level;  ///< the derivatives of the energy level of the run by its start
  double end = std::numeric_limits<double>::infinity();  ///< of the run, where it is known beforehand
};

/// max |MᵀJM − J| over the entries of the first 2n rows and columns, J = (0 I; −I 0).
double symplectic_defect(const TangentMap& map);

struct ContactDefect {
  double defect;  ///< max |φ*η − λη| over dq, dp, ds
  double factor;  ///< λ, read off ds
};
/// Of the contact form η = ds − p·dq over a map of (q, p, s).
ContactDefect contact_defect(const TangentMap& map);
/// det M
double determinant(const TangentMap& map);

}  // namespace least
