// Steps of the scheme `taylor` (core/schemes/taylor.hpp) on states whose size is known when they run. What a state
// carries beyond the motion, an action or a tangent direction, goes along and has no say in the steps. Sums over steps
// are compensated. Where a step ends in what is no state of the motion it is repeated at half the length.
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
  /// Steps are so long that a quantity may change its sign more than once: they are looked at in so many parts.
  static constexpr int parts = 16;

  /// Variables of the series that stand behind those of the state and follow from them, as velocities that are found
  /// from momenta: written there by `complete`. Null: there are none.
  struct Completion {
    void (*complete)(const void* of, double t, double* variables) = nullptr;
    const void* of = nullptr;
  };

  explicit TaylorStepper(std::shared_ptr<taylor::Expansion> expansion, Completion completion = {nullptr, nullptr});

  StepStatus step(RunState& x) noexcept;
  /// A step that is at most so long: where it is as long to the bit, it has come to what lies so far ahead. `late`: by
  /// how much rounding has made x.t too late, for a caller who minds that where the step ends.
  StepStatus step_within(RunState& x, double most, double late = 0) noexcept;
  /// How long the last step was: the time after it is rounded.
  double elapsed() const { return h_; }
  /// x moved to the time t, not before its own, by as many steps as that takes.
  StepStatus reach(RunState& x, double t) noexcept;
  /// x set to the state at t by the polynomial of the last step; false where t lies outside it.
  bool interpolate(RunState& x, double t) const noexcept;
  const Work& work() const noexcept { return work_; }
  /// How much rounding within the formulas of the motion may have made steps be off, all together (Expansion::blur).
  double blur() const { return blur_; }
  /// One that has taken no step yet, of the same program.
  TaylorStepper anew() const { return TaylorStepper(expansion_, completion_); }

 private:
  /// Of the variables of the series, with room for a whole four where three stand behind others.
  using Values = StateNumbers;
  /// What is kept, by its place in `values_`: where the last step began and where it ended, with what rounding has kept
  /// from either, and scratch. Places are exchanged where values would be copied.
  struct Places {
    std::size_t start = 0, start_low = 1, end = 2, low = 3, from = 4, from_low = 5;
  };
  /// Where the series of what is carried was last begun within a step; scratch.
  struct Mark {
    double after = 0;  ///< the step's beginning
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
  /// Of the state y at the time h after t, to which the series of the motion has led, what is carried: in as many steps
  /// as it needs, from the mark on, which goes along. False, and what is carried NaN: it is not to go on
  /// (AskedByThread).
  bool carry(double t, double h, Mark& mark, Values& low, Values& y) const noexcept;
  /// Where a step begins: where the last one ended, with what rounding has kept from it, but for what is changed.
  void begin(const RunState& x) noexcept;
  /// The variables of the series at a state.
  void read(const RunState& x, Values& y) const;

  std::shared_ptr<taylor::Expansion> expansion_;
  Completion completion_;
  bool carries_;
  double t_ = 0, h_ = 0;  ///< of the last step
  double blur_ = 0;
  Places at_;
  mutable std::array<Values, 6> values_;
  /// In the last step: states in between, asked for in turn, cost few series; and of `reach`.
  mutable Mark mark_, reached_, scratch_;
  Work work_;
};

}  // namespace least
