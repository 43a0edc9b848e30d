// Members whose steps are written down alike: they differ in their states, and in constants where their parameters
// differ.
#pragma once

#include <map>
#include <memory>

#include "core/ensemble/lane_task.hpp"
#include "core/ensemble/step_trace.hpp"

namespace least {

class MemberGroup {
 public:
  explicit MemberGroup(StepTrace&& shape) : shape_(std::move(shape)) { shape_.trace.close(); }

  bool has(const StepTrace& trace) const { return trace.has_shape_of(shape_); }
  /// A member by its place in the block, with the constants of its own trace; none, and so of all: the group's.
  void add(std::size_t member, std::vector<double> constants);
  // When all are there:
  /// Each member's value of the k-th parameter that varies.
  void set_parameter(std::size_t k, std::span<const double> values);
  /// What is asked of states.
  void compile_values();
  /// Why no run of the task can begin with the i-th member; `completed`: it can. The state is near enough for that to
  /// be a question where it is `near`. What ω² is compared with on the way is set for the member.
  ReturnCode objection_to_start(std::size_t i, const LaneTask& task, const double* state, bool near);
  /// The step, when objection_to_start was asked for all members; and whether it fits the trace.
  void compile_steps();

  const std::vector<std::size_t>& members() const { return members_; }
  bool has_steps() const { return shape_.end > shape_.begin; }
  const LaneProgram& step() const { return steps_->view; }
  /// Rows of the card that the state is made of.
  const std::vector<std::uint32_t>& rows() const { return shape_.rows; }
  /// The table of a task.
  const double* own() const { return own_of_step_.data(); }

  // Of the i-th member; states are in the order of the card.
  void columns(std::size_t i, double t, const double* state, double* out);
  /// The variables that the state is made of, after a step; false: it fails.
  bool advance(std::size_t i, double t, double h, const double* before, double* state);

 private:
  /// A program with the constants that each member has of its own, member by member.
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
  /// What the program makes of a state of the i-th member.
  const double* evaluate(const MemberProgram& program, std::size_t i, double t, double h, const double* state);

  StepTrace shape_;
  std::vector<std::size_t> members_;
  std::vector<std::vector<double>> constants_;           ///< of each member, or none
  std::map<std::size_t, std::vector<double>> replaced_;  ///< constants by number, and in their place one of each member
  Program steps_, columns_, starts_;
  std::vector<double> own_of_step_, values_;
};

}  // namespace least
