// Members whose steps have equal traces: they differ in their states, and in constants where their parameters differ.
#pragma once

#include <map>
#include <memory>

#include "core/ensemble/lane_task.hpp"
#include "core/ensemble/step_trace.hpp"

namespace least {

/// MemberGroup is used in this order: add all members, set_parameter and compile_values, objection_to_start of all
/// members, compile_steps.
class MemberGroup {
 public:
  explicit MemberGroup(StepTrace&& shape) : shape_(std::move(shape)) { shape_.trace.close(); }

  bool has(const StepTrace& trace) const { return trace.has_shape_of(shape_); }
  /// add(member, constants): `member` is the place in the block, `constants` those of its own trace; empty for all
  /// members: those of the group's trace.
  void add(std::size_t member, std::vector<double> constants);
  // Once all members are there:
  /// set_parameter(k, values) sets each member's value of the k-th varied parameter.
  void set_parameter(std::size_t k, std::span<const double> values);
  /// compile_values() compiles the columns and the checks at the start.
  void compile_values();
  /// objection_to_start returns why no run of the task can begin with the i-th member; `completed` where it can. `near`
  /// tells that the state is small enough for the motion to be evaluated. Sets the member's limit of ω².
  ReturnCode objection_to_start(std::size_t i, const LaneTask& task, const double* state, bool near);
  /// compile_steps() compiles the step, with the constants that objection_to_start has set.
  void compile_steps();

  const std::vector<std::size_t>& members() const { return members_; }
  const LaneProgram& step() const { return steps_->view; }
  /// rows() returns, by component of the state, its place on the card.
  const std::vector<std::uint32_t>& rows() const { return shape_.rows; }
  /// own() returns the table for a LaneTask.
  const double* own() const { return own_of_step_.data(); }

  // For the i-th member; states are in the order of the card.
  void columns(std::size_t i, double t, const double* state, double* out);
  /// advance replaces the components of the state by those after a step; false: the step fails.
  bool advance(std::size_t i, double t, double h, const double* before, double* state);

 private:
  /// MemberProgram is a program with the members' own constants.
  struct MemberProgram {
    explicit MemberProgram(const LaneSource& source) : lanes(source), view(lanes.program()) {}
    MemberProgram(const MemberProgram&) = delete;
    MemberProgram& operator=(const MemberProgram&) = delete;
    CompiledLanes lanes;
    LaneProgram view;
    std::vector<double> own;
  };
  using Program = std::unique_ptr<const MemberProgram>;

  std::size_t constant_at(Trace::Place place) const {
    return static_cast<std::size_t>(shape_.trace.nodes()[static_cast<std::size_t>(place)].a);
  }
  double constant_of(std::size_t i, std::size_t constant) const;
  Program compiled(LaneSource source) const;
  /// evaluate returns the program's values at a state of the i-th member.
  const double* evaluate(const MemberProgram& program, std::size_t i, double t, double h, const double* state);

  StepTrace shape_;
  std::vector<std::size_t> members_;
  std::vector<std::vector<double>> constants_;  ///< by member; empty: all have those of the trace
  /// By number of the constant, a value for each member in its place
  std::map<std::size_t, std::vector<double>> replaced_;
  Program steps_, columns_, starts_;
  std::vector<double> own_of_step_, values_;
};

}  // namespace least
