// Steps of the scheme `taylor` (core/schemes/taylor.hpp) on states whose size is known only at run time. Components
// that a state carries beyond the motion, an action or a tangent direction, do not influence the steps. Sums over steps
// are compensated. A step that ends where the equations are undefined is repeated at half the length.
#pragma once

#include <array>
#include <memory>

#include "core/run/run_state.hpp"
#include "core/schemes/expansion.hpp"
#include "core/status.hpp"

namespace least {

class TaylorStepper {
 public:
  static constexpr bool reads_time = true, has_dense = true;
  /// Steps are so long that a quantity may change its sign more than once within one: they are searched in so many
  /// parts.
  static constexpr int parts = 16;

  /// Completion computes the variables of the series that follow those of the state and depend on them, as velocities
  /// found from momenta: `complete` writes them to `variables`. Null: there are none.
  struct Completion {
    void (*complete)(const void* of, double t, double* variables) = nullptr;
    const void* of = nullptr;
  };

  explicit TaylorStepper(std::shared_ptr<taylor::Expansion> expansion, Completion completion = {nullptr, nullptr});

  StepStatus step(RunState& x) noexcept;
  /// Takes a step of at most `most`. If elapsed() is exactly `most`, the step ends exactly that far ahead. `late`: by
  /// how much rounding has made x.t too late, for a caller that needs the exact end of the step.
  StepStatus step_within(RunState& x, double most, double late = 0) noexcept;
  /// The length of the last step; the time after it is rounded.
  double elapsed() const { return h_; }
  /// Moves x to the time t, not before x.t, by as many steps as necessary.
  StepStatus reach(RunState& x, double t) noexcept;
  /// Sets x to the state at t by the polynomial of the last step; false if t lies outside the step.
  bool interpolate(RunState& x, double t) const noexcept;
  const Work& work() const noexcept { return work_; }
  /// An estimate of the error of all steps by rounding within the formulas of the motion (Expansion::blur).
  double blur() const { return blur_; }
  /// A new stepper of the same program and with the same tolerance, without steps.
  TaylorStepper anew() const {
    TaylorStepper made(expansion_, completion_);
    made.least_size_ = least_size_;
    return made;
  }

 private:
  /// Values of the variables of the series, with one place more, so that three trailing values can be read as a group
  /// of four.
  using Values = StateNumbers;
  /// Places are indices into `values_`: start and end of the last step with the low-order parts of their compensated
  /// sums, and scratch. Indices are exchanged instead of values copied.
  struct Places {
    std::size_t start = 0, start_low = 1, end = 2, low = 3, from = 4, from_low = 5;
  };
  /// Mark is the point within a step from which the series of the carried components was last expanded; scratch.
  struct Mark {
    double after = 0;  ///< time since the beginning of the step
    Values y{}, low{};

    void set(const Values& at, const Values& kept) {
      after = 0;
      y = at;
      low = kept;
    }
  };

  std::size_t count() const { return expansion_->program().variables; }
  std::size_t moving() const { return expansion_->program().moving; }
  Values& values(std::size_t place) const { return values_[place]; }
  /// carry computes the carried components of the state y at the time t + h, to which the series of the motion has led,
  /// in as many steps as they need from the mark on; the mark moves along. False, and these components NaN, if the
  /// computation is to end (AskedByThread).
  bool carry(double t, double h, Mark& mark, Values& low, Values& y) const noexcept;
  /// expand expands the motion at the state y and the time t.
  void expand(const Values& y, double t) const noexcept;
  /// begin sets the start of a step: the end of the last one with the low-order parts of its sums, except for
  /// components of x that have changed.
  void begin(const RunState& x) noexcept;
  /// read writes the variables of the series at a state.
  void read(const RunState& x, Values& y) const;

  std::shared_ptr<taylor::Expansion> expansion_;
  Completion completion_;
  bool carries_;
  double t_ = 0, h_ = 0;  ///< start and length of the last step
  double blur_ = 0;
  mutable double least_size_ = 0;  ///< size of a state below which errors are absolute; 0: no step was taken
  Places at_;
  mutable std::array<Values, 6> values_;
  /// mark_ is in the last step, so that states asked for in order of time cost few series; reached_ is that of `reach`.
  mutable Mark mark_, reached_, scratch_;
  Work work_;
};

}  // namespace least
