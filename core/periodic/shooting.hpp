// The equations of a closed orbit and their solution by Newton's method: multiple shooting, Φ(x_i) = x_{i+1} from node
// to node and back to x_0 at last, in the sense of least squares, with the solution closest to the guess. Each
// conserved quantity makes one equation depend on the others; these are projected out. Sources: Keller, Numerical
// Methods for Two-Point Boundary-Value Problems, 1968; Muñoz-Almaraz et al., Physica D 181, 1 (2003); Deuflhard, Newton
// Methods for Nonlinear Problems, 2011, 4.4 (rank-deficient Gauss-Newton).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/periodic/conserved.hpp"
#include "core/periodic/motion.hpp"

namespace least::periodic {

/// Trial is an approximate orbit.
struct Trial {
  std::vector<std::vector<double>> nodes;  ///< states x_0, x_1, … at the nodes
  std::vector<double> at;                  ///< times of the nodes as fractions of the period, from 0
  double period = 0;
  double value = 0;  ///< of the varied parameter
};

/// Look is what integrating a trial gives.
struct Look {
  std::vector<Reached> segments;
  std::vector<double> defects;  ///< Φ(x_i) − x_{i+1}, node by node, in units of the extents
  double closure = 0;           ///< the largest defect in absolute value
};

/// PeriodLaw is how the period depends on a varied parameter: unknown (free), not at all (kept), or, as the period of a
/// drive, inversely or in proportion.
enum class PeriodLaw { free, kept, inverse, proportional };

/// Setting holds what all orbits of one question share.
struct Setting {
  std::shared_ptr<const Scene> scene;
  double tolerance = 1e-12;
  std::vector<bool> fixed;          ///< by component, whether it keeps its value
  PeriodLaw law = PeriodLaw::free;  ///< free: the period is an unknown
  /// The period is kept only to make orbits unique for each value of a parameter; a family may release it
  bool period_held = false;
  std::optional<std::size_t> varied;  ///< the parameter that a family varies
  std::optional<std::size_t> led;     ///< component of the start along which a family may also move by symmetries
  double guess_period = 0, guess_value = 0;
  std::vector<double> extents;  ///< units of the components: the extents of the guess
  double value_unit = 1;
  /// By component, by how much x(T) exceeds x(0) on a closed orbit, such as 2π for an angle
  std::vector<double> turns;

  double start() const { return scene->start; }
  double period_at(double value) const;
  double period_slope(double value) const;  ///< dT/dvalue
};

/// FurtherRow is an additional equation: coefficients · (change of unknowns) = −missing, in the order of
/// Shooting::unknowns.
struct FurtherRow {
  std::vector<double> coefficients;
  double missing = 0;
};

/// Shooting solves the equations for the orbits of one setting.
class Shooting {
 public:
  /// `setting` and `effort` must outlive the Shooting. `motion` belongs to the value at which the setting begins. All
  /// members may throw what Motion throws.
  Shooting(const Setting& setting, std::shared_ptr<Motion> motion, Effort& effort);

  /// unknowns counts the unknowns: the changes of all nodes one after the other, of the period, and of the value, in
  /// their units.
  static std::size_t unknowns(const Trial& trial) { return trial.nodes.size() * trial.nodes[0].size() + 2; }

  /// look integrates a trial. Nothing where the motion cannot be followed; `reason` then says why.
  std::optional<Look> look(const Trial& trial, std::string& reason);
  /// refine inserts nodes, on the orbit itself, where differences grow too much within a segment.
  bool refine(Trial& trial, std::string& reason);

  struct Corrected {
    Trial trial;
    Look look;
    bool closed = false;
    int iterations = 0;
    std::string reason;  ///< why it was given up; empty where it was not
  };
  /// correct applies Newton's method to a trial, with one additional equation if `further` is given. Where the orbit
  /// does not close, the best trial is returned.
  Corrected correct(Trial trial, const std::function<FurtherRow(const Trial&)>& further, int iterations_allowed);
  /// along_family projects `wish` onto the changes of unknowns that keep the orbit closed.
  std::vector<double> along_family(const Trial& trial, const Look& look, std::vector<double> wish);

  /// prepare returns the motion for a trial's value; motion and conserved quantities stay valid until another value is
  /// prepared.
  Motion& prepare(const Trial& trial);
  const Conserved& conserved() const { return *conserved_; }
  const variations::ParametricScene& equations() const { return motion_->equations(); }

  static constexpr double close_enough = 1e-9;  ///< in units of the extents

 private:
  struct Equations {
    Matrix rows;
    std::vector<double> right;
    /// Whether the parameter breaks the conservation of a quantity: it moves the end of the orbit along the quantity's
    /// gradient, so that a closed orbit does not continue along the parameter. Source: Guckenheimer, Holmes, Nonlinear
    /// Oscillations, 1983, 4.5 (Melnikov's condition).
    bool breaks = false;
  };
  Equations equations(const Trial& trial, const Look& look, const FurtherRow* further);
  Matrix ways_that_rest(const Trial& trial) const;

  const Setting& setting_;
  Effort& effort_;
  std::shared_ptr<Motion> motion_;
  double value_ = 0;
  std::optional<Conserved> conserved_;
};

/// moved returns the trial changed by `by` times a direction of its unknowns.
Trial moved(const Trial& trial, const Setting& setting, std::span<const double> way, double by);

}  // namespace least::periodic
