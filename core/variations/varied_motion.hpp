// A motion with first and second derivatives along directions of its start and parameters, by its Taylor series. With
// few variables and only first derivatives, steps are precomputed (core/variations/steps_ahead.hpp); otherwise all
// directions are followed step by step (core/tape/tangents.hpp). The variational equations are homogeneous in a
// direction together with its parameter changes, so that derivatives are rescaled by powers of two from step to step
// and keep full precision however far they grow. Where the equations switch sides, at a zero of g, rates may jump from
// f₋ to f₊: there u becomes u + (f₋ − f₊) ∂t/∂θ, ∂t/∂θ = −(g_x u + g_θ w)/(g_x f₋ + g_t), w being the change of the
// parameter; second derivatives are not carried across such a jump. Sources: Barrio, SIAM J. Sci. Comput. 27, 1929
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

/// ParameterChange is the rate of change of a parameter of the card along a direction.
struct ParameterChange {
  std::size_t parameter;
  double by;
};
/// Direction lists the parameters that change along a direction, beside the start; it is empty where only the start
/// changes.
using Direction = std::vector<ParameterChange>;

/// switches(scene) tells whether the equations contain case distinctions (select).
bool switches(const ParametricScene& scene);

/// Derivatives of a state: direction by direction and pair by pair, each as long as the state.
struct Derivatives {
  std::vector<double> first, second;
};

/// VariedMotion advances a motion and its derivatives step by step, and looks at both within the next step.
class VariedMotion {
 public:
  /// `pairs` are the pairs of directions whose second derivatives are followed; `order` is that of the series, 0 for
  /// the cheapest. Throws tape::TooManyOperations, MemoryShortage.
  VariedMotion(const ParametricScene& scene, std::span<const Direction> directions,
               std::span<const std::pair<std::size_t, std::size_t>> pairs, double tolerance, int order = 0);

  /// start(x, derivatives, t) begins at the state x with these derivatives.
  void start(std::span<const double> x, const Derivatives& derivatives, double t);
  /// start_with_control also starts a control of order control_order, where steps are precomputed, along the sum of the
  /// directions with these weights. The control ends at the next start.
  void start_with_control(std::span<const double> x, const Derivatives& derivatives, double t,
                          std::span<const double> weights, int control_order);
  /// control() returns the control's derivative in its direction at the last look; nothing where there is no control.
  std::optional<std::vector<double>> control();
  double time() const { return t_; }
  int order() const { return ahead_ ? ahead_->order() : expansion_->order(); }
  /// reach() returns the latest time of looks before the next step; time() where the motion cannot be continued.
  double reach() const { return reach_; }
  /// look(t) evaluates state() and derivatives() at a time within the next step. False: they are not finite there.
  bool look(double t);
  /// advance(end) takes a step to `end`, or as far as it goes. False: the motion cannot be continued.
  bool advance(double end);

  std::span<const double> state() const { return std::span(seen_).first(size_); }
  Derivatives derivatives() const;

 private:
  /// Level holds all first derivatives, or all second ones, of all variables; `lanes` directions or pairs are
  /// interleaved.
  struct Level {
    std::size_t count, lanes;
    std::vector<int> exponents;      ///< numbers are stored divided by 2^exponent
    std::vector<double> u{}, low{};  ///< at the last step, with compensations
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
  /// sides returns the rates, then the values whose change of sign switches them.
  template <class T>
  std::vector<T> sides(const std::vector<T>& x, const T& t) const;
  std::vector<double> with_parameters(const std::vector<double>& y) const;

  std::size_t size_;
  double tolerance_;
  double least_size_ = 0;  ///< size of a state below which errors are absolute; 0: not started
  int order_;              ///< as asked for
  std::vector<Direction> by_;
  std::vector<std::size_t> varied_;  ///< parameters that the series has as variables behind the state, ascending
  std::vector<tape::Tangents::Pair> pairs_;
  Held held_ = HeldByThread::take(0);
  /// Precomputed steps, where these suit; otherwise, or from where they cannot continue, the next members take over
  std::optional<StepsAhead> ahead_;
  bool one_by_one_ = false;
  std::optional<tape::Program> varied_program_;  ///< kept for expansion_ and tangents_ where ahead_ exists
  std::optional<taylor::Expansion> expansion_;
  std::optional<tape::Tangents> tangents_;
  std::optional<tape::Formula> sides_;  ///< where the equations switch; see sides
  std::vector<double> parameters_;
  double t_ = 0, reach_ = 0, longest_ = 0, looked_ = 0;
  std::vector<double> y_, seen_;        ///< state and varied parameters, at the last step and at the last look
  std::vector<double> low_, low_seen_;  ///< their compensations
  Level first_, second_;
  /// By pair, the factor of products of first derivatives, as the levels are scaled by different powers of two
  std::vector<double> shares_;
};

}  // namespace least::variations
