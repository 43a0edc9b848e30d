// Steps of a motion that are computed before those of its derivatives. The motion does not depend on its derivatives,
// so that some steps of it can be precomputed, and the matrices of change of the derivatives in these steps be computed
// side by side (core/tape/step_tangents.hpp).
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/schemes/expansion.hpp"
#include "core/tape/step_tangents.hpp"
#include "core/variations/control_motion.hpp"

namespace least::variations {

/// StepsAhead keeps a queue of precomputed steps of a motion y and, for each step, the matrix C by which derivatives u
/// change: u⁺ = u + C u. y are the variables that move, then the varied parameters. Compensations, named `low`, hold
/// what rounding has lost from a number.
class StepsAhead {
 public:
  /// suit tells whether precomputed steps are cheaper than following so many directions step by step.
  static bool suit(const tape::Program& varied, std::size_t directions);
  /// numbers(varied) returns about how many doubles are kept.
  static std::size_t numbers(const tape::Program& varied);
  /// `motion` is the program with numbers for all parameters; in `varied` some parameters are variables of rate 0,
  /// behind those of the motion. Steps are a little shorter than those of the motion alone, for the sake of the
  /// derivatives.
  StepsAhead(tape::Program motion, tape::Program varied, double tolerance, int order);

  int order() const { return expansion_.order(); }
  /// expansion() returns the series of the motion, for looks within a step.
  taylor::Expansion& expansion() { return expansion_; }

  /// begin() discards the queue, the knowledge about step lengths, and the control.
  void begin() {
    leave();
    part_ = 1;
    control_.reset();
  }
  /// control(…) starts a control at the current place, along a direction of all variables.
  void control(const tape::Program& varied, int order, std::vector<double> direction);
  /// control_at returns the control's direction after the time h of the current step, where the motion is at y.
  std::vector<double> control_at(double h, std::span<const double> y, std::span<const double> low);
  bool controlled() const { return control_ != nullptr; }
  /// next(y, low, t, least) makes the next step the current one: the next of the queue, or the first of newly computed
  /// ones. False: steps would be shorter than `least`, or a number is not finite.
  bool next(std::span<const double> y, std::span<const double> low, double t, double least);
  /// The end of the current step: its time, and the state there without parameters, with its compensation.
  double end() const { return ends_[at_]; }
  std::span<const double> state() const { return part(states_); }
  std::span<const double> low() const { return part(lows_); }
  /// last_terms returns the largest last and second to last Taylor coefficients of the change of u in the current step;
  /// NaN where one is. u has `lanes` directions, interleaved by variable as in tape::Tangents.
  std::pair<double, double> last_terms(std::span<const double> u, std::size_t lanes);
  /// change replaces derivatives u and their compensations by those at the end of the current step; change_in by those
  /// after the time h.
  void change(std::span<double> u, std::span<double> low, std::size_t lanes);
  void change_in(double h, std::span<double> u, std::span<double> low, std::size_t lanes);
  /// take() marks the current step as taken.
  void take();
  /// take_part(h, y, low) tells the control that the current step was taken for the time h only, to the state y;
  /// leave() must follow.
  void take_part(double h, std::span<const double> y, std::span<const double> low);
  /// leave() discards the queue. `shorter` ≤ 1 multiplies the lengths of further steps, where the current one was too
  /// long.
  void leave(double shorter = 1);

 private:
  std::span<const double> part(const std::vector<double>& all) const {
    return std::span(all).subspan(at_ * size_, size_);
  }
  bool make(std::span<const double> y, std::span<const double> low, double t, double least);
  void multiply(const double* matrix, std::span<const double> u, std::size_t lanes);
  double largest() const;
  void add(std::span<double> u, std::span<double> low);
  /// The current step with the end y and the matrix of that end.
  ControlMotion::Step step_to(std::span<const double> y, std::span<const double> low, const double* matrix) const;

  taylor::Expansion expansion_;
  tape::StepTangents tangents_;
  std::size_t size_, columns_;
  double part_ = 1;  ///< length of steps relative to those that the motion alone would take
  std::size_t at_ = 0, count_ = 0;
  std::vector<double> begins_, times_, lengths_, ends_, states_, lows_;  ///< by step
  std::vector<double> low_;               ///< compensation at the beginning of the first step of the queue
  std::vector<double> product_, matrix_;  ///< scratch
  std::unique_ptr<ControlMotion> control_;
};

}  // namespace least::variations
