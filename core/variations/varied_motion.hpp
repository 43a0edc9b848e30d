// A motion with its first and second derivatives in directions of its start and its parameters, along its Taylor
// series: by steps that lie ready (core/variations/steps_ahead.hpp) where there are few variables and first derivatives
// alone are asked for, and direction by direction (core/tape/tangents.hpp) else. They are homogeneous in each
// direction, of which parameters are a part, so that derivatives are rescaled by powers of two from step to step and
// have as many digits as the motion, however far they grow. Where the equations switch sides, at a zero of g, rates may
// jump from f₋ to f₊: there u becomes u + (f₋ − f₊) ∂t/∂θ, ∂t/∂θ = −(g_x u + g_θ w)/(g_x f₋ + g_t), w being the change
// of the parameter; second derivatives are not taken over a jump. Sources: Barrio, SIAM J. Sci. Comput. 27, 1929
// (2006); Leine, Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/schemes/expansion.hpp"
#include "core/tape/formula.hpp"
#include "core/tape/tangents.hpp"
#include "core/variations/parametric.hpp"
#include "core/variations/steps_ahead.hpp"

namespace least::variations {

/// How much a parameter of the card changes along a direction.
struct ParameterChange {
  std::size_t parameter;
  double by;
};
/// What a derivative is along: parameters that change, beside what the start does. None: it is the start that moves.
using Direction = std::vector<ParameterChange>;

/// Whether equations switch between sides.
bool switches(const ParametricScene& scene);

/// First and, of pairs, second derivatives of a state: d by d, each as long as the state.
struct Derivatives {
  std::vector<double> first, second;
};

class VariedMotion {
 public:
  /// `pairs`: of directions, whose second derivatives are followed. `order`: of the series; 0: the cheapest. Throws
  /// tape::TooManyOperations, MemoryShortage.
  VariedMotion(const ParametricScene& scene, std::span<const Direction> directions,
               std::span<const std::pair<std::size_t, std::size_t>> pairs, double tolerance, int order = 0);

  void start(std::span<const double> x, const Derivatives& derivatives, double t);
  /// The same, and where steps lie ready a control goes beside them, along a sum of the directions with these weights,
  /// by series of the order; up to the next start.
  void start_with_control(std::span<const double> x, const Derivatives& derivatives, double t,
                          std::span<const double> weights, int control_order);
  /// The derivative in that direction as the control has it, where it was looked last; nothing: there is none.
  std::optional<std::vector<double>> control();
  double time() const { return t_; }
  int order() const { return ahead_ ? ahead_->order() : expansion_->order(); }
  /// The time that the next step may go to; time() where the motion does not go on.
  double reach() const { return reach_; }
  /// What is seen becomes the motion at a time within the next step. False: it is not finite there.
  bool look(double t);
  /// A step to `end`, or as far as it can go. False: the motion does not go on.
  bool advance(double end);

  std::span<const double> state() const { return std::span(seen_).first(size_); }
  Derivatives derivatives() const;

 private:
  /// The first derivatives, direction by direction, or the second ones, pair by pair: of all variables, lane by lane.
  struct Level {
    std::size_t count, lanes;
    std::vector<int> exponents;      ///< of two: by what they have been divided
    std::vector<double> u{}, low{};  ///< at the last step, and what rounding has kept from them
    std::vector<double> seen{}, low_seen{};
  };
  tape::Program program_of(const ParametricScene& scene, const std::vector<std::size_t>& varied) const;
  void follow_directions(tape::Program program);
  void follow_one_by_one();
  bool ahead() const { return ahead_ && !one_by_one_; }
  taylor::Expansion& motion() { return ahead() ? ahead_->expansion() : *expansion_; }
  void put(Level& level, const std::vector<double>& derivatives);
  void begin(std::span<const double> x, const Derivatives& derivatives, double t);
  void take(const Level& level, std::vector<double>& derivatives) const;
  void settle_scales();
  void settle(Level& level, std::span<const double> beside);
  void plan();
  bool plan_ahead();
  bool advance_ahead(double end);
  void step_to(double to);
  double derivatives_step();
  void prepare_switches(const ParametricScene& scene);
  std::vector<double> rates_before(double to) const;
  void cross_switch(double to);
  /// The rates of the motion, and then what changes its sign at switches.
  template <class T>
  std::vector<T> sides(const std::vector<T>& x, const T& t) const;
  std::vector<double> with_parameters(const std::vector<double>& y) const;

  std::size_t size_;
  double tolerance_;
  int order_;  ///< that was asked for
  std::vector<Direction> by_;
  std::vector<std::size_t> varied_;  ///< parameters that are variables of the series, after the state
  std::vector<tape::Tangents::Pair> pairs_;
  Held held_ = HeldByThread::take(0);
  std::optional<StepsAhead> ahead_;  ///< where it suits; else, or from a place where it does not, the two that follow
  bool one_by_one_ = false;
  std::optional<tape::Program> varied_program_;  ///< for these, where there is something ahead
  std::optional<taylor::Expansion> expansion_;
  std::optional<tape::Tangents> tangents_;
  std::optional<tape::Formula> sides_;  ///< where the equations switch
  std::vector<double> parameters_;
  double t_ = 0, reach_ = 0, longest_ = 0, looked_ = 0;
  std::vector<double> y_, seen_;        ///< the state, at the last step and where it was looked, and what is varied
  std::vector<double> low_, low_seen_;  ///< what rounding has kept from them
  Level first_, second_;
  std::vector<double> shares_;  ///< what products of first derivatives count in those of a pair
};

}  // namespace least::variations
