// Members of a scene as text whose steps are written down alike: they differ in their states, and in constants where
// their parameters differ.
#pragma once

#include "core/ensemble/lane_task.hpp"
#include "core/ensemble/text_trace.hpp"

namespace least {

class TextGroup {
 public:
  explicit TextGroup(TextTrace&& shape) : shape_(std::move(shape)) { shape_.trace.close(); }

  bool has(const TextTrace& trace) const { return trace.has_shape_of(shape_); }
  /// A member by its place in the block, with the constants of its own trace.
  void add(std::size_t member, std::vector<double> constants);
  /// When all are there.
  void compile();

  const std::vector<std::size_t>& members() const { return members_; }
  const LaneProgram& step() const { return step_; }
  /// The table of a task.
  const double* own() const { return own_of_step_.data(); }

  // Of the i-th member; states are in the order of the card.
  /// Whether a run can begin there, of steps of the length h where that is not 0.
  bool starts(std::size_t i, double t, double h, const double* state) const;
  void columns(std::size_t i, double t, const double* state, double* out) const;
  /// The variables that the state is made of, after a step; false: it fails.
  bool advance(std::size_t i, double t, double h, const double* before, double* state) const;

 private:
  std::vector<double> own_of(std::size_t i, const CompiledLanes& lanes) const;
  std::optional<CompiledLanes> compiled(LaneSource source) const;

  TextTrace shape_;
  std::vector<std::size_t> members_;
  std::vector<std::vector<double>> constants_;
  std::optional<CompiledLanes> steps_, columns_, starts_;
  LaneProgram step_, column_, start_;
  std::vector<double> own_of_step_;
};

}  // namespace least
