// Steps of a group of members: packs of lanes, one after the other, so that the latency of one is hidden by the
// others. Only units of lanes include this header.
#pragma once

#include <algorithm>
#include <memory>

#include "core/ensemble/lane_square.hpp"

// The schemes see lanes only where they come first.
#include "core/ensemble/lane_clock.hpp"
#include "core/ensemble/lane_schemes.hpp"
#include "core/problem_traits.hpp"

namespace least {

/// Of each lane whether it goes on.
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
/// What does not depend on the lane fails all of them.
LEAST_INLINE bool all_failed(LaneStatuses& status, bool where, StepStatus) {
  if (where) status.well = {};
  return where;
}

template <>
struct StatusFor<Lanes> {
  using type = LaneStatuses;
};

/// The narrowest unit does it all: parameters of each lane's own, and s wherever there is one. Wider ones share the
/// parameters and what follows from them, and carry what the motion needs: that is fast, and half of the compilation.
inline constexpr bool general = LEAST_LANE_BYTES == 16;

inline constexpr std::size_t packs = 8 / lane_registers;
inline constexpr std::size_t group_size = packs * lane_count;
template <class T>
using Group = std::array<T, packs>;

/// What is seen of the steps of a block, by pack.
struct StepObservations {
  Group<LaneMask> well, inside, slow;  ///< slow: ω² was below its limit for sure
  Group<Lanes> lowest{};               ///< s
  StepObservations() {
    well.fill(LaneMask::everywhere());
    slow = inside = well;
  }
};

/// What may go wrong with a pack, in the order in which a lone run looks for it.
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

inline LaneMask finite(const Lanes* x, std::size_t size) {
  constexpr double largest_component = 1e75;
  LaneMask good = LaneMask::everywhere();
  for (std::size_t i = 0; i < size; ++i) good = good & (abs(x[i]) < Lanes(largest_component));
  return good;
}

/// The states of a group and their steps by one scheme, erased, with what its problem says of states. What a step reads
/// and writes lies close together: loads behind stores a whole number of pages away would wait for them.
class GroupSteps {
 public:
  virtual ~GroupSteps() = default;
  /// The components of the states.
  std::size_t size() const { return size_; }
  Lanes* state(std::size_t j) { return states_ + j * stride_; }
  const Lanes* state(std::size_t j) const { return states_ + j * stride_; }
  /// Only so many packs are asked for from now on.
  void use(std::size_t count) { used_ = count; }

  /// `count` steps of the length h from the n-th on, on the grid t₀ + n·step; t is the time of the states.
  virtual void advance(double t, double start, double step, std::int64_t n, std::int64_t count, double h,
                       StepObservations& seen) = 0;
  virtual void keep() = 0;
  virtual void take_back() = 0;
  /// What belongs to the state of a lane of another group, which made as many steps, and is kept here.
  virtual void take_lane(GroupSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                         std::size_t lane) = 0;
  virtual Work work() const = 0;
  /// What speaks against beginning with the pack's states.
  virtual LaneFaults at_start(const LaneTask&, std::size_t j) {
    LaneFaults faults;
    faults.add(!finite(state(j), size_), ReturnCode::not_finite);
    return faults;
  }
  /// What went wrong with the pack. Of a single step exactly; of more, what may have gone wrong.
  virtual LaneFaults after(std::size_t j, const StepObservations& seen, [[maybe_unused]] double step, bool) {
    LaneFaults faults;
    faults.add(!seen.well[j], ReturnCode::singular);
    faults.add(!finite(state(j), size_), ReturnCode::not_finite);
    return faults;
  }

 protected:
  std::size_t used() const { return used_; }
  /// States of so many components, the next one so many Lanes behind.
  void show_states(Lanes* first, std::size_t size, std::size_t stride) {
    states_ = first;
    size_ = size;
    stride_ = stride;
  }

 private:
  Lanes* states_ = nullptr;
  std::size_t size_ = 0, stride_ = 0, used_ = packs;
};

/// The state of a pack.
template <class X>
LEAST_INLINE X state_of(const Lanes* x, double t) {
  X y;
  y.t = t;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i];
  return y;
}

/// That of a problem by whatever scheme.
template <class P, class X>
class ProblemSteps : public GroupSteps {
 public:
  explicit ProblemSteps(const Group<P>& problems) : problems_(problems) {}

  LaneFaults at_start(const LaneTask& task, std::size_t j) override {
    using enum ReturnCode;
    const P& problem = problems_[j];
    const X x = state_of<X>(state(j), task.start_time);
    const bool moves = task.steps > 0;
    LaneFaults faults;
    faults.add(!finite(state(j), X::size), not_finite);
    if constexpr (HasDomain<P>)
      if (problem.bounded()) faults.add(problem.inside(x.q) < Lanes(0), left_domain);
    if constexpr (VectorField<P>) {
      const X slope = derivative(problem, x);
      Lanes all[X::size];
      for (std::size_t i = 0; i < X::size; ++i) all[i] = slope[i];
      faults.add(!finite(all, X::size), singular);
    }
    if constexpr (QuadraticContact<P>)
      if (moves) faults.add(pole(j, x.action.s, task.step), singular);
    if constexpr (HasFrequency<P>) {
      const Lanes turn(problem.frequency_squared(position(x)));
      const LaneMask fast = limit_turns(task, j, turn);
      if (moves) faults.add(fast, unstable_step);
    }
    return faults;
  }
  LaneFaults after(std::size_t j, const StepObservations& seen, [[maybe_unused]] double step,
                   [[maybe_unused]] bool exactly) override {
    using enum ReturnCode;
    LaneFaults faults;
    faults.add(!seen.well[j], singular);
    if constexpr (QuadraticContact<P>) faults.add(pole(j, seen.lowest[j], step), singular);
    const LaneMask good = finite(state(j), X::size);
    if constexpr (HasDomain<P>)
      if (problems_[j].bounded()) faults.add(!seen.inside[j] & good, left_domain);
    faults.add(!good, not_finite);
    if constexpr (watches_turns)
      faults.add(exactly ? Lanes(problems_[j].frequency_squared(position(state_of<X>(state(j), 0)))) > limit_[j]
                         : !seen.slow[j],
                 unstable_step);
    return faults;
  }

 protected:
  static constexpr bool watches_turns = HasFrequency<P> && !ConstantFrequency<P>;

  const P& problem(std::size_t j) const { return problems_[j]; }
  /// What a step compares ω² with: for all packs the same where they share the parameters.
  Lanes limit(std::size_t j) const { return limit_[j]; }
  Lanes screen(std::size_t j) const { return screen_[j]; }
  LEAST_INLINE static LaneMask turns_slowly(const P& problem, const X& y, const Lanes& limit,
                                            const Lanes& screen) requires watches_turns {
    std::array<LaneSquare, std::tuple_size_v<std::remove_cvref_t<decltype(position(y))>>> q;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = position(y)[i];
    return is_below(problem.frequency_squared(q), limit, screen);
  }
  void take_limit(const ProblemSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                  std::size_t lane) {
    limit_[pack][lane] = other.limit_[from_pack][from];
    screen_[pack][lane] = other.screen_[from_pack][from];
  }

 private:
  LaneMask pole(std::size_t j, const Lanes& s, double step) const requires QuadraticContact<P> {
    return -(problems_[j].action_curvature() * s * step) > Lanes(2);
  }
  /// Sets the limits, and says whose ω² is above.
  LaneMask limit_turns(const LaneTask& task, std::size_t j, const Lanes& turn) requires HasFrequency<P> {
    const double square = task.step * task.step;
    const auto damping_step = [&](std::size_t lane) {
      if constexpr (ConstantDamping<P>) return std::max(lane_of(problems_[j].damping(), lane), 0.0) * task.step;
      return 0.0;
    };
    LaneMask fast{};
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      const double alpha = damping_step(lane);
      if constexpr (ConstantFrequency<P>) {
        if (task.steps > 0 && task.host->is_too_fast(turn[lane] * square, alpha)) fast.set(lane, true);
      } else {
        limit_[j][lane] =
            lane > 0 && alpha == damping_step(lane - 1) ? limit_[j][lane - 1] : task.host->turn_limit(alpha) / square;
      }
    }
    if constexpr (ConstantFrequency<P>) return fast;
    screen_[j] = screen_of(limit_[j]);
    return turn > limit_[j];
  }
  template <class R>
  static double lane_of(const R& x, std::size_t lane) {
    if constexpr (std::is_same_v<R, Lanes>) {
      return x[lane];
    } else {
      return x;
    }
  }

  Group<P> problems_;
  Group<Lanes> limit_{}, screen_{};  ///< of ω²
};

/// By a scheme, which outlives it.
template <class P, class X, class Scheme>
class BoundGroup final : public ProblemSteps<P, X> {
 public:
  BoundGroup(const Scheme& scheme, const Group<P>& problems, const Lanes* x, double t)
      : ProblemSteps<P, X>(problems),
        slots_(bind(scheme, x, t, std::make_index_sequence<packs>{})),
        kept_{kept(std::make_index_sequence<packs>{})} {
    this->show_states(slots_[0].x, X::size, sizeof(Slot) / sizeof(Lanes));
  }

  [[gnu::noinline, gnu::flatten]] void advance(double t, double start, double step, std::int64_t n, std::int64_t count,
                                               double h, StepObservations& seen) override {
    using Steps = ProblemSteps<P, X>;
    const std::size_t used = this->used();
    [[maybe_unused]] P problem = this->problem(0);
    [[maybe_unused]] Lanes limit = this->limit(0), screen = this->screen(0);
    for (std::int64_t end = n + count; n < end;) {
      for (std::size_t j = 0; j < used; ++j) {
        Slot& slot = slots_[j];
        if constexpr (general && (Steps::watches_turns || HasDomain<P>)) {
          problem = this->problem(j);
          limit = this->limit(j);
          screen = this->screen(j);
        }
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
    this->take_limit(from_group, from_pack, from, pack, lane);
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
    return {Slot(bound(scheme, J, x, t), x + J * X::size)...};
  }
  template <std::size_t... J>
  Group<Stepper> kept(std::index_sequence<J...>) const {
    return {slots_[J].stepper...};
  }
  [[gnu::noinline]] Stepper bound(const Scheme& scheme, std::size_t j, const Lanes* x, double t) const {
    return scheme.bind(this->problem(j), state_of<X>(x + j * X::size, t));
  }

  Group<Slot> slots_;
  Group<Stepper> kept_;
};

/// Of a scheme, and of the states of a group at the time t.
template <class P>
using BindGroup = std::unique_ptr<GroupSteps> (*)(const void* scheme, const Group<P>& problems, const Lanes* x,
                                                  double t);
template <class P, class X, class Scheme>
std::unique_ptr<GroupSteps> bind_group(const void* scheme, const Group<P>& problems, const Lanes* x, double t) {
  return std::unique_ptr<GroupSteps>(new BoundGroup<P, X, Scheme>(*static_cast<const Scheme*>(scheme), problems, x, t));
}
/// f(a scheme, its BindGroup, the bytes of a group), where the scheme at that place of lane_schemes can run the
/// problem.
template <class P, class X, class F>
void with_bound_scheme(std::size_t place, std::span<const double> settings, F&& f) {
  with_lane_scheme(place, settings, [&]<class Scheme>(const Scheme& scheme) {
    if constexpr (requires { typename StepperOf<Scheme, P, X>; })
      f(&scheme, BindGroup<P>(bind_group<P, X, Scheme>), sizeof(BoundGroup<P, X, Scheme>));
  });
}

}  // namespace least
