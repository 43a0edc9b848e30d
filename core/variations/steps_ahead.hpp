// Steps of a motion that are made before its derivatives are: the motion does not depend on these, so that some steps
// can lie ready and what derivatives change by in them be found side by side (core/tape/step_tangents.hpp).
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/schemes/expansion.hpp"
#include "core/tape/step_tangents.hpp"
#include "core/variations/control_motion.hpp"

namespace least::variations {

class StepsAhead {
 public:
  /// Whether they are cheaper than to follow so many directions step by step.
  static bool suit(const tape::Program& varied, std::size_t directions);
  /// How many numbers they keep, about.
  static std::size_t numbers(const tape::Program& varied);
  /// `motion`: the equations with numbers for parameters; `varied`: with some of them as variables that rest, after
  /// those of the motion. Steps are a little shorter than those of the motion alone, as derivatives need them.
  StepsAhead(tape::Program motion, tape::Program varied, double tolerance, int order);

  int order() const { return expansion_.order(); }
  /// The series of the motion where a step begins: for what is looked at within it.
  taylor::Expansion& expansion() { return expansion_; }

  /// Nothing lies ready, and nothing is known of steps that are too long. No control goes beside them.
  void begin() {
    leave();
    part_ = 1;
    control_.reset();
  }
  /// Then one goes beside them, from here on, along a direction of all variables.
  void control(const tape::Program& varied, int order, std::vector<double> direction);
  /// That direction as the control has it in the time h of the step, where the first motion is at y.
  std::vector<double> control_at(double h, std::span<const double> y, std::span<const double> low);
  bool controlled() const { return control_ != nullptr; }
  /// The next step, from the state y, of all variables, at the time t: the one that lies ready, or the first of others
  /// that are made. False: the motion does not go on for longer than `least`, or some term is no number.
  bool next(std::span<const double> y, std::span<const double> low, double t, double least);
  /// Where that step begins it ends at; the state there, without parameters, and what rounding has kept from it.
  double end() const { return ends_[at_]; }
  std::span<const double> state() const { return part(states_); }
  std::span<const double> low() const { return part(lows_); }
  /// Of derivatives u that stand as tape::Tangents has them, the terms of the last order and of the one before of what
  /// they change by: the largest of each over all; NaN where one is none.
  std::pair<double, double> last_terms(std::span<const double> u, std::size_t lanes);
  /// Derivatives where the step ends, or after the time h: from u and what rounding has kept from it, `low`.
  void change(std::span<double> u, std::span<double> low, std::size_t lanes);
  void change_in(double h, std::span<double> u, std::span<double> low, std::size_t lanes);
  /// It has been taken to its end.
  void take();
  /// It has been taken for the time h, to the state y, and is left as below.
  void take_part(double h, std::span<const double> y, std::span<const double> low);
  /// It is left, as are those behind it. `shorter`: it was too long by this factor.
  void leave(double shorter = 1);

 private:
  std::span<const double> part(const std::vector<double>& all) const {
    return std::span(all).subspan(at_ * size_, size_);
  }
  bool make(std::span<const double> y, std::span<const double> low, double t, double least);
  void multiply(const double* matrix, std::span<const double> u, std::size_t lanes);
  double largest() const;
  void add(std::span<double> u, std::span<double> low);
  /// The step with another end and the matrix of that.
  ControlMotion::Step step_to(std::span<const double> y, std::span<const double> low, const double* matrix) const;

  taylor::Expansion expansion_;
  tape::StepTangents tangents_;
  std::size_t size_, columns_;
  double part_ = 1;  ///< of the steps that the motion alone would take
  std::size_t at_ = 0, count_ = 0;
  std::vector<double> begins_, times_, lengths_, ends_, states_, lows_;  ///< of each step
  std::vector<double> low_;                                              ///< where the first of them begins
  std::vector<double> product_, matrix_;                                 ///< scratch
  std::unique_ptr<ControlMotion> control_;
};

}  // namespace least::variations
