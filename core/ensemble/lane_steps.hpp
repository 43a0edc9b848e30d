// Steps of a group of members: packs of lanes are stepped in turn, so that each hides the latency of the others. Only
// the lane units include this header.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>

#include "core/number/lanes.hpp"

// The lane header must come before the schemes.
#include "core/ensemble/lane_clock.hpp"
#include "core/ensemble/lane_schemes.hpp"
#include "core/ensemble/square.hpp"
#include "core/problem_traits.hpp"

namespace least {

/// screen_of returns a bound for squares that stands for a limit: the limit's square, reduced slightly so that nothing
/// above the limit passes. Values between are to be checked exactly.
LEAST_INLINE Lanes screen_of(const Lanes& limit) {
  constexpr double most = 1e300, room = 1 - 1e-9;
  const Lanes square = limit * limit * Lanes(room);
  return select((square > Lanes(most)) & (limit < Lanes(std::numeric_limits<double>::infinity())), Lanes(most), square);
}
/// is_below tells whether a is surely below the limit; false where the squares do not decide, or underflow.
LEAST_INLINE LaneMask is_below(const Square<Lanes>& a, const Lanes& limit, const Lanes& screen) {
  if (a.plain) return a.value <= limit;
  const Lanes least(1e-300);
  return select(least > a.over, least, a.over) <= screen * a.under;
}

/// LaneStatuses tells, by lane, whether the step has succeeded so far.
struct LaneStatuses {
  LaneMask well;
  LEAST_INLINE LaneStatuses(StepStatus all)  // NOLINT(google-explicit-constructor): one for all
      : well(succeeded(all) ? LaneMask::everywhere() : LaneMask{}) {}
};
LEAST_INLINE LaneMask succeeded(const LaneStatuses& status) { return status.well; }
LEAST_INLINE bool all_failed(LaneStatuses& status, const LaneMask& where, StepStatus) {
  status.well = status.well & !where;
  return !any(status.well);
}
/// A condition that does not depend on the lane fails all lanes.
LEAST_INLINE bool all_failed(LaneStatuses& status, bool where, StepStatus) {
  if (where) status.well = {};
  return where;
}

template <>
struct StatusFor<Lanes> {
  using type = LaneStatuses;
};

inline constexpr std::size_t packs = 8 / lane_registers;
inline constexpr std::size_t group_size = packs * lane_count;
template <class T>
using Group = std::array<T, packs>;

/// StepObservations collects observations over the steps of a block, by pack.
struct StepObservations {
  Group<LaneMask> well, inside, slow;  ///< slow: ω² was surely below its limit
  Group<Lanes> lowest{};               ///< the smallest s
  StepObservations() {
    well.fill(LaneMask::everywhere());
    slow = inside = well;
  }
};

/// LaneFaults are the possible faults of a pack, in the order in which a lone run looks for them.
class LaneFaults {
 public:
  struct Fault {
    LaneMask where;
    ReturnCode why = ReturnCode::completed;
  };
  void add(const LaneMask& where, ReturnCode why) { all_[count_++] = {where, why}; }
  const Fault* begin() const { return all_.data(); }
  const Fault* end() const { return all_.data() + count_; }

 private:
  std::array<Fault, 5> all_;
  std::size_t count_ = 0;
};

/// finite returns the lanes in which all components are finite and not huge.
inline LaneMask finite(const Lanes* x, std::size_t size) {
  constexpr double largest_component = 1e75;
  LaneMask good = LaneMask::everywhere();
  for (std::size_t i = 0; i < size; ++i) good = good & (abs(x[i]) < Lanes(largest_component));
  return good;
}

/// GroupSteps is the type-erased stepper of a group with its states, and the checks of its problem. What a step reads
/// and writes is kept close together: a load that follows a store at a distance of a whole number of pages would stall.
class GroupSteps {
 public:
  virtual ~GroupSteps() = default;
  /// size() returns the number of components of a state.
  std::size_t size() const { return size_; }
  Lanes* state(std::size_t j) { return states_ + j * stride_; }
  const Lanes* state(std::size_t j) const { return states_ + j * stride_; }
  /// use(count) restricts steps to the first packs.
  void use(std::size_t count) { used_ = count; }

  /// advance takes `count` steps of length h from number n on; step n begins at start + n·step, and t is the time of
  /// the states.
  virtual void advance(double t, double start, double step, std::int64_t n, std::int64_t count, double h,
                       StepObservations& seen) = 0;
  virtual void keep() = 0;
  virtual void take_back() = 0;
  /// take_lane copies what belongs to a lane's state but is stored in the stepper, from a group that has made as many
  /// steps.
  virtual void take_lane(GroupSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                         std::size_t lane) = 0;
  virtual Work work() const = 0;
  /// at_start returns what forbids beginning with the states of pack j.
  virtual LaneFaults at_start(const LaneTask&, std::size_t j) {
    LaneFaults faults;
    faults.add(!finite(state(j), moving_), ReturnCode::not_finite);
    return faults;
  }
  /// after returns the faults of pack j: with `exactly`, those of a single step; otherwise a superset, which must be
  /// checked step by step.
  virtual LaneFaults after(std::size_t j, const StepObservations& seen, [[maybe_unused]] double step, bool) {
    LaneFaults faults;
    faults.add(!seen.well[j], ReturnCode::singular);
    faults.add(!finite(state(j), moving_), ReturnCode::not_finite);
    return faults;
  }

 protected:
  std::size_t used() const { return used_; }
  std::size_t moving() const { return moving_; }
  /// show_states tells where the states are: `size` components each, the first `moving` of which the motion needs;
  /// consecutive states are `stride` Lanes apart.
  void show_states(Lanes* first, std::size_t size, std::size_t moving, std::size_t stride) {
    states_ = first;
    size_ = size;
    moving_ = moving;
    stride_ = stride;
  }

 private:
  Lanes* states_ = nullptr;
  std::size_t size_ = 0, moving_ = 0, stride_ = 0, used_ = packs;
};

/// state_of returns the state of a pack.
template <class X>
LEAST_INLINE X state_of(const Lanes* x, double t) {
  X y;
  y.t = t;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i];
  return y;
}

/// ProblemSteps has the checks of problem P, whatever the scheme. All members share its parameters.
template <class P, class X>
class ProblemSteps : public GroupSteps {
 public:
  explicit ProblemSteps(const P& problem) : problem_(problem) {}

  LaneFaults at_start(const LaneTask& task, std::size_t j) override {
    using enum ReturnCode;
    const X x = state_of<X>(state(j), task.start_time);
    const bool moves = task.steps > 0;
    LaneFaults faults;
    faults.add(!finite(state(j), X::size), not_finite);
    if constexpr (HasDomain<P>)
      if (problem_.bounded()) faults.add(problem_.inside(x.q) < Lanes(0), left_domain);
    if constexpr (VectorField<P>) {
      const X slope = derivative(problem_, x);
      Lanes all[X::size];
      for (std::size_t i = 0; i < X::size; ++i) all[i] = slope[i];
      faults.add(!finite(all, X::size), singular);
    }
    if constexpr (QuadraticContact<P>)
      if (moves) faults.add(pole(x.action.s, task.step), singular);
    if constexpr (HasFrequency<P>) {
      const LaneMask fast = limit_turns(task, Lanes(problem_.frequency_squared(position(x))));
      if (moves) faults.add(fast, unstable_step);
    }
    return faults;
  }
  LaneFaults after(std::size_t j, const StepObservations& seen, [[maybe_unused]] double step,
                   [[maybe_unused]] bool exactly) override {
    using enum ReturnCode;
    LaneFaults faults;
    faults.add(!seen.well[j], singular);
    if constexpr (QuadraticContact<P>) faults.add(pole(seen.lowest[j], step), singular);
    const LaneMask good = finite(state(j), X::size);
    if constexpr (HasDomain<P>)
      if (problem_.bounded()) faults.add(!seen.inside[j] & good, left_domain);
    faults.add(!good, not_finite);
    if constexpr (watches_turns)
      faults.add(
          exactly ? Lanes(problem_.frequency_squared(position(state_of<X>(state(j), 0)))) > limit_ : !seen.slow[j],
          unstable_step);
    return faults;
  }

 protected:
  static constexpr bool watches_turns = HasFrequency<P> && !ConstantFrequency<P>;

  const P& problem() const { return problem_; }
  /// Bounds for ω²: the limit, and the screen for its square.
  Lanes limit() const { return limit_; }
  Lanes screen() const { return screen_; }
  LEAST_INLINE static LaneMask turns_slowly(const P& problem, const X& y, const Lanes& limit,
                                            const Lanes& screen) requires watches_turns {
    std::array<Square<Lanes>, std::tuple_size_v<std::remove_cvref_t<decltype(position(y))>>> q;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = position(y)[i];
    return is_below(problem.frequency_squared(q), limit, screen);
  }

 private:
  LaneMask pole(const Lanes& s, double step) const requires QuadraticContact<P> {
    return -(problem_.action_curvature() * s * step) > Lanes(2);
  }
  /// limit_turns sets the bounds and returns the members whose ω² is above.
  LaneMask limit_turns(const LaneTask& task, const Lanes& turn) requires HasFrequency<P> {
    const double square = task.step * task.step;
    double damping_step = 0;
    if constexpr (ConstantDamping<P>) damping_step = std::max(problem_.damping(), 0.0) * task.step;
    if constexpr (ConstantFrequency<P>) {
      LaneMask fast{};
      for (std::size_t lane = 0; lane < lane_count; ++lane)
        fast.set(lane, task.steps > 0 && task.host->is_too_fast(turn[lane] * square, damping_step));
      return fast;
    }
    limit_ = Lanes(task.host->turn_limit(damping_step) / square);
    screen_ = screen_of(limit_);
    return turn > limit_;
  }

  P problem_;
  Lanes limit_{}, screen_{};  ///< bounds for ω²
};

/// BoundGroup steps problem P by a scheme, which must outlive it.
template <class P, class X, class Scheme>
class BoundGroup final : public ProblemSteps<P, X> {
 public:
  BoundGroup(const Scheme& scheme, const P& problem, const Lanes* x, double t)
      : ProblemSteps<P, X>(problem),
        slots_(bind(scheme, x, t, std::make_index_sequence<packs>{})),
        kept_{kept(std::make_index_sequence<packs>{})} {
    this->show_states(slots_[0].x, X::size, X::size, sizeof(Slot) / sizeof(Lanes));
  }

  [[gnu::noinline, gnu::flatten]] void advance(double t, double start, double step, std::int64_t n, std::int64_t count,
                                               double h, StepObservations& seen) override {
    using Steps = ProblemSteps<P, X>;
    const std::size_t used = this->used();
    [[maybe_unused]] const P problem = this->problem();
    [[maybe_unused]] const Lanes limit = this->limit(), screen = this->screen();
    for (std::int64_t end = n + count; n < end;) {
      for (std::size_t j = 0; j < used; ++j) {
        Slot& slot = slots_[j];
        X y = state_of<X>(slot.x, t);
        const StatusOf<Lanes> status = slot.stepper.step(y, h);
        seen.well[j] = seen.well[j] & succeeded(status);
        if constexpr (Steps::watches_turns)
          seen.slow[j] = seen.slow[j] & Steps::turns_slowly(problem, y, limit, screen);
        if constexpr (QuadraticContact<P>)
          seen.lowest[j] = select(y.action.s < seen.lowest[j], y.action.s, seen.lowest[j]);
        if constexpr (HasDomain<P>) seen.inside[j] = seen.inside[j] & (problem.inside(position(y)) >= Lanes(0));
        for (std::size_t i = 0; i < X::size; ++i) slot.x[i] = y[i];
      }
      t = start + static_cast<double>(++n) * step;
    }
  }
  void keep() override {
    for (std::size_t j = 0; j < this->used(); ++j) kept_[j] = slots_[j].stepper;
  }
  void take_back() override {
    for (std::size_t j = 0; j < this->used(); ++j) slots_[j].stepper = kept_[j];
  }
  void take_lane(GroupSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                 std::size_t lane) override {
    std::array<double, 2 * X::size> kept;  // NOLINT: written before it is read
    std::size_t out = 0, in = 0;
    auto& from_group = static_cast<BoundGroup&>(other);
    from_group.slots_[from_pack].stepper.each_kept([&](const Lanes& x) { kept[out++] = x[from]; });
    slots_[pack].stepper.each_kept([&](Lanes& x) { x[lane] = kept[in++]; });
  }
  Work work() const override { return slots_[0].stepper.work(); }

 private:
  using Stepper = StepperOf<Scheme, P, X>;
  struct alignas(sizeof(Lanes)) Slot {
    Slot(Stepper&& made, const Lanes* state) : stepper(std::move(made)) { std::copy_n(state, X::size, x); }
    Lanes x[X::size];
    Stepper stepper;
  };
  template <std::size_t... J>
  Group<Slot> bind(const Scheme& scheme, const Lanes* x, double t, std::index_sequence<J...>) const {
    return {Slot(bound(scheme, x + J * X::size, t), x + J * X::size)...};
  }
  template <std::size_t... J>
  Group<Stepper> kept(std::index_sequence<J...>) const {
    return {slots_[J].stepper...};
  }
  [[gnu::noinline]] Stepper bound(const Scheme& scheme, const Lanes* x, double t) const {
    return scheme.bind(this->problem(), state_of<X>(x, t));
  }

  Group<Slot> slots_;
  Group<Stepper> kept_;
};

/// BindGroup makes a GroupSteps from a scheme and the states of a group at the time t.
template <class P>
using BindGroup = std::unique_ptr<GroupSteps> (*)(const void* scheme, const P& problem, const Lanes* x, double t);
template <class P, class X, class Scheme>
std::unique_ptr<GroupSteps> bind_group(const void* scheme, const P& problem, const Lanes* x, double t) {
  return std::unique_ptr<GroupSteps>(new BoundGroup<P, X, Scheme>(*static_cast<const Scheme*>(scheme), problem, x, t));
}

/// Schemes that are compiled for the lanes of every problem. Steps of all others run as programs.
template <class Scheme>
inline constexpr bool compiled_in_lanes = std::is_same_v<Scheme, Leapfrog> || std::is_same_v<Scheme, ContactLeapfrog> ||
                                          std::is_same_v<Scheme, ContactSplitting>;
/// with_bound_scheme calls f(scheme, its BindGroup, bytes of a group) if the scheme at that place of lane_schemes is
/// compiled for the problem.
template <class P, class X, class F>
void with_bound_scheme(std::size_t place, std::span<const double> settings, F&& f) {
  with_lane_scheme(place, settings, [&]<class Scheme>(const Scheme& scheme) {
    if constexpr (compiled_in_lanes<Scheme>)
      if constexpr (requires { typename StepperOf<Scheme, P, X>; })
        f(&scheme, BindGroup<P>(bind_group<P, X, Scheme>), sizeof(BoundGroup<P, X, Scheme>));
  });
}

}  // namespace least
