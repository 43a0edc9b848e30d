// The structure that a step conserves, measured by its map and tangent in numbers: for a conservative scene the defect
// MᵀJM − J of the tangent map M, J = (0 I; −I 0); for a scene with a contact form η = ds − p·dq the defect of φ*η = λη.
// Both are zero to round-off for a symplectic or contact scheme. Sources: Hairer, Lubich, Wanner 2006, VI.2; Vermeeren,
// Bravetti, Seri, J. Phys. A 52, 445206 (2019), section 2.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "core/run/run_state.hpp"
#include "core/scheme.hpp"

namespace least {

/// TangentMap is the tangent of a map from one state to another, both with s if the scene has one. In an extended space
/// the time is the last coordinate, with its own momentum.
struct TangentMap {
  std::size_t dof = 0;    ///< number of coordinates of the space
  RunState from, to;      ///< components q, p, and s if there is one
  std::vector<double> m;  ///< m[i·size + j] = ∂to_i/∂from_j
  bool extended = false;

  std::size_t size() const { return from.size(); }
  double slope(std::size_t i, std::size_t j) const { return m[i * size() + j]; }
};

/// ChangeOfStep is the image of a state under a step, and its derivative along one direction. A scheme that sets its
/// own clock maps neighbouring states to different times.
struct ChangeOfStep {
  RunState to;
  StateNumbers change;
  double longer = 0;      ///< derivative of the length of the step
  ActiveMethod course{};  ///< how a hybrid took the step
};

/// StepTangents are the tangents of the steps of a run, always those of the full state. Functions are empty if the
/// scheme has none.
struct StepTangents {
  /// along writes the change of the step from x, after a step by the method `before`, where x changes by u, the time by
  /// dt and the energy level of the run by `level`; false if the step fails.
  std::function<bool(const RunState& x, const ActiveMethod& before, const StateNumbers& u, double dt, double level,
                     ChangeOfStep& to)>
      along;
  /// Called before each direction; false gives up, like a step that fails.
  using KeepGoing = std::function<bool()>;
  /// plain writes the tangent along all directions, at the same time and energy level.
  std::function<bool(const RunState& x, const KeepGoing& keep_going, TangentMap& map)> plain;
  /// extended does the same on the extended space, for schemes whose steps are contact maps there.
  std::function<bool(const RunState& x, const KeepGoing& keep_going, TangentMap& map)> extended;
  std::vector<double> level;  ///< derivatives of the energy level of the run with respect to its start
  double end = std::numeric_limits<double>::infinity();  ///< end of the run, if known beforehand
};

/// symplectic_defect returns max |MᵀJM − J| over the entries of the first 2n rows and columns, J = (0 I; −I 0), in
/// balanced units of the coordinates.
double symplectic_defect(const TangentMap& map);

struct ContactDefect {
  double defect;  ///< max |φ*η − λη| over dq, dp, ds
  double factor;  ///< λ, the coefficient of ds
};
/// contact_defect measures how far a map of (q, p, s) is from conserving the contact form η = ds − p·dq up to a factor.
ContactDefect contact_defect(const TangentMap& map);
/// det M
double determinant(const TangentMap& map);

}  // namespace least
