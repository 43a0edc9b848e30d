// The equations of a closed orbit and their solution by Newton's method: multiple shooting, Φ(x_i) = x_{i+1} from node
// to node and at last x_0 again, in the sense of least squares, of all solutions that which changes the guess the
// least. What the motion keeps makes as many of the equations follow from the others: they are projected out. Sources:
// Keller, Numerical Methods for Two-Point Boundary-Value Problems, 1968; Muñoz-Almaraz et al., Physica D 181, 1 (2003);
// Deuflhard, Newton Methods for Nonlinear Problems, 2011, 4.4 (rank-deficient Gauss-Newton).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/periodic/conserved.hpp"
#include "core/periodic/motion.hpp"

namespace least::periodic {

/// An orbit on the way to be closed.
struct Trial {
  std::vector<std::vector<double>> nodes;  ///< x_0 … of components
  std::vector<double> at;                  ///< when, as parts of the period, from 0
  double period = 0;
  double value = 0;  ///< of the parameter that is varied
};

/// What its motion says.
struct Look {
  std::vector<Reached> segments;
  std::vector<double> defects;  ///< Φ(x_i) − x_{i+1}, node by node, in units of the extents
  double closure = 0;           ///< the largest of them
};

/// How the period follows from a parameter that is varied, where it is that of a drive.
enum class PeriodLaw { free, kept, inverse, proportional };

/// What is asked of all orbits of one question.
struct Setting {
  std::shared_ptr<const Scene> scene;
  double tolerance = 1e-12;
  std::vector<bool> fixed;            ///< of the components: they keep their values
  PeriodLaw law = PeriodLaw::free;    ///< free: the period is looked for
  bool period_held = false;           ///< it is kept so that a parameter has one orbit for each value, and may be free
  std::optional<std::size_t> varied;  ///< the parameter of a family
  std::optional<std::size_t> led;     ///< a component of the start along which a family goes by symmetries, too
  double guess_period = 0, guess_value = 0;
  std::vector<double> extents;  ///< units of the components: how far the guess moves
  double value_unit = 1;
  std::vector<double> turns;  ///< of the components: by how much an orbit closes on itself later, as by 2π

  double start() const { return scene->start; }
  double period_at(double value) const;
  double period_slope(double value) const;  ///< dT/dvalue
};

/// A further equation, linear in the changes of the unknowns: coefficients as `Shooting::unknowns` counts them.
struct FurtherRow {
  std::vector<double> coefficients;
  double missing = 0;
};

class Shooting {
 public:
  /// `setting` and `effort` outlive it. `motion`: for the value that the setting begins with. What follows throws what
  /// Motion throws.
  Shooting(const Setting& setting, std::shared_ptr<Motion> motion, Effort& effort);

  /// Unknowns are the changes of all nodes, one after the other, of the period and of the value, in their units.
  static std::size_t unknowns(const Trial& trial) { return trial.nodes.size() * trial.nodes[0].size() + 2; }

  /// Nothing: it cannot be followed, for the reason.
  std::optional<Look> look(const Trial& trial, std::string& reason);
  /// More nodes where differences grow by more than is good from one to the next, from the orbit itself.
  bool refine(Trial& trial, std::string& reason);

  struct Corrected {
    Trial trial;
    Look look;
    bool closed = false;
    int iterations = 0;
    std::string reason;  ///< why it was given up; empty: it was not
  };
  /// Newton's method from a trial; `further`: another row of a trial, or none. Where it does not close it keeps its
  /// best.
  Corrected correct(Trial trial, const std::function<FurtherRow(const Trial&)>& further, int iterations_allowed);
  /// What changes of the unknowns keep an orbit closed: the part of `wish` that is one of them.
  std::vector<double> along_family(const Trial& trial, const Look& look, std::vector<double> wish);

  /// The motion, and what it keeps, for the value of a trial; both stay until they are prepared for another one.
  Motion& prepare(const Trial& trial);
  const Conserved& conserved() const { return *conserved_; }
  const variations::ParametricScene& equations() const { return motion_->equations(); }

  static constexpr double close_enough = 1e-9;  ///< of the extents

 private:
  struct Equations {
    Matrix rows;
    std::vector<double> right;
  };
  Equations equations(const Trial& trial, const Look& look, const FurtherRow* further);
  Matrix ways_that_rest(const Trial& trial) const;

  const Setting& setting_;
  Effort& effort_;
  std::shared_ptr<Motion> motion_;
  double value_ = 0;
  std::optional<Conserved> conserved_;
};

/// Moved along a direction of its unknowns.
Trial moved(const Trial& trial, const Setting& setting, std::span<const double> way, double by);

}  // namespace least::periodic
