// The curve of closed orbits along which a number of the scene or of the orbit changes, followed by pseudo-arclength
// continuation: a step along the tangent, then Newton's method orthogonal to it, so that the curve continues through
// folds. Sources: Keller, in Applications of Bifurcation Theory, 1977, 359; Doedel, Keller, Kernévez, Int. J.
// Bifurcation and Chaos 1, 493 (1991).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/periodic/bifurcations.hpp"
#include "core/periodic/orbits.hpp"

namespace least::periodic {

/// Step is a member together with what continuing from it needs.
struct Step {
  Trial trial;
  Look look;
  Orbit orbit;
  std::vector<double> tangent;   ///< of length 1
  double value = 0, pace = 0;    ///< pace: dvalue/ds, in units of the value
  std::vector<double> velocity;  ///< ẋ at the first node, in units of the extents; empty where the scene is driven
  Matrix symmetries;             ///< changes of all unknowns, as columns, that shift the orbit along its symmetries
  Crossings crossings;
};

/// TestFunction changes its sign where what it tests for lies between two members.
using TestFunction = std::function<double(const Step&)>;

class Curve {
 public:
  /// `motion` belongs to the value of the guess in the setting.
  Curve(const FamilyAsked& asked, Setting setting, std::shared_ptr<Motion> motion, Effort& effort);

  /// begin returns the first member, with the tangent along which the number moves towards `to`. Nothing where no curve
  /// goes through it along which the number moves; `reason` then says why.
  std::optional<Step> begin(const Trial& first, std::string& reason);

  /// Made is a member that a step led to, and how many iterations it took.
  struct Made {
    std::optional<Step> step;  ///< nothing where no closed orbit was found that continues the curve
    int iterations = 0;
  };
  /// along returns the member at the distance ds along the tangent of `here`, landed the member whose number is `to`,
  /// expected at that distance.
  Made along(const Step& here, double ds);
  Made landed(const Step& here, double ds);
  /// zero_between returns the member between a and b, which is ds from a, at which the test function vanishes: by
  /// regula falsi with the Illinois modification.
  Step zero_between(const Step& a, const Step& b, double ds, const TestFunction& test);
  /// value_at_rest returns the family's number at the equilibrium that the curve goes through between a and b, or soon
  /// after b: beyond it are the same orbits half a period later, and the velocity at the first node has the other sign.
  /// Nothing where the velocity there does not vanish.
  std::optional<double> value_at_rest(Step a, const Step& b);
  /// distance returns how far b is from a along the tangent of a.
  double distance(const Step& a, const Step& b) const;
  /// more_nodes refines a member whose differences grow too fast, keeping the known parts of its tangent. False: the
  /// motion cannot be followed, or there is no tangent.
  bool more_nodes(Step& step);
  /// extent returns the largest extent of a member's orbit, in units of those of the guess; NaN where it cannot be
  /// followed.
  double extent(const Step& step);
  /// period_slope returns dT/dvalue along the curve; NaN at a fold.
  double period_slope(const Step& step) const;

  const Setting& setting() const { return setting_; }

 private:
  using By = FamilyAsked::By;

  double value_of(const Trial& trial);
  std::size_t component() const;
  bool holds_components() const;
  bool let_more_move(const Step& first);
  void hold_start(const Step& first);
  std::vector<double> gradient(const Trial& trial);
  bool finish(Step& step, const std::vector<double>& wish);
  Made corrected(const Step& here, double ds, const std::function<FurtherRow(const Trial&)>& further);
  std::vector<double> way_on(const Step& from, const Trial& at);
  std::vector<double> change(const Trial& from, const Trial& to) const;
  std::vector<double> velocity_at(const Trial& trial);
  Matrix symmetries_of(const Trial& trial);
  bool connected(const Step& a, const Step& b, double ds) const;

  const FamilyAsked& asked_;
  Setting setting_;
  Effort& effort_;
  Shooting shooting_;
};

}  // namespace least::periodic
