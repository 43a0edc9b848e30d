// Steps of a group of members: eight packs of lanes, one after the other, so that the latency of one is hidden by the
// others. Only units of lanes include this header.
#pragma once

#include "core/number/lanes.hpp"

// The schemes see lanes only where they come first.
#include "core/ensemble/lane_clock.hpp"
#include "core/ensemble/lane_schemes.hpp"
#include "core/problem_traits.hpp"

namespace least {

/// A status for each lane.
struct LaneStatuses {
  LaneMask::Vector of;
  LEAST_INLINE LaneStatuses(StepStatus all)  // NOLINT(google-explicit-constructor): one for all
      : of(static_cast<std::int64_t>(all) - LaneMask::Vector{}) {}
};
LEAST_INLINE LaneMask succeeded(const LaneStatuses& status) { return {status.of == 0}; }
LEAST_INLINE bool all_failed(LaneStatuses& status, const LaneMask& where, StepStatus why) {
  const auto code = static_cast<std::int64_t>(why) - LaneMask::Vector{};
  status.of = (where.on & (status.of == 0)) ? code : status.of;
  return !any(succeeded(status));
}
/// What does not depend on the lane fails all of them.
LEAST_INLINE bool all_failed(LaneStatuses& status, bool where, StepStatus why) {
  return where && all_failed(status, LaneMask{LaneMask::Vector{} - 1}, why);
}

template <>
struct StatusFor<Lanes> {
  using type = LaneStatuses;
};

/// The narrowest unit does it all: parameters of each lane's own, and s wherever there is one. Wider ones share the
/// parameters and what follows from them, and carry what the motion needs: that is fast, and half of the compilation.
inline constexpr bool general = LEAST_LANE_BYTES == 16;

inline constexpr std::size_t packs = 8;
inline constexpr std::size_t group_size = packs * lane_count;
template <class X>
using Group = std::array<X, packs>;

/// What is seen of the steps of a block, by pack.
struct Seen {
  Group<LaneMask> failed{}, left{};
  Group<Lanes> turn{}, lowest{};  ///< the largest ω², the lowest s
};

/// The steps of a group by one scheme, erased.
template <class P, class X>
class GroupSteps {
 public:
  virtual ~GroupSteps() = default;
  /// `count` steps of the length h from the n-th on, on the grid t₀ + n·step.
  virtual void advance(Group<X>& x, double start, double step, std::int64_t n, std::int64_t count, double h,
                       Seen& seen) = 0;
  virtual void keep() = 0;
  virtual void take_back() = 0;
  /// What belongs to the state of a lane of another group, which made as many steps, and is kept here.
  virtual void take_lane(GroupSteps& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                         std::size_t lane) = 0;
  virtual Work work() const = 0;
};

template <class P, class X, class Scheme>
class BoundGroup final : public GroupSteps<P, X> {
 public:
  BoundGroup(const Scheme& scheme, const Group<P>& problems, const Group<X>& x)
      : scheme_(scheme), problems_(problems), steppers_(bind(x, std::make_index_sequence<packs>{})), kept_(steppers_) {}

  [[gnu::noinline, gnu::flatten]] void advance(Group<X>& x, double start, double step, std::int64_t n,
                                               std::int64_t count, double h, Seen& seen) override {
    for (std::int64_t end = n + count; n < end;) {
      const double t = start + static_cast<double>(++n) * step;
      for (std::size_t j = 0; j < packs; ++j) {
        X y;  // in registers: what the stepper writes is not part of it
        assign(y, x[j]);
        const StatusOf<Lanes> status = steppers_[j].step(y, h);
        seen.failed[j] = seen.failed[j] | !succeeded(status);
        if constexpr (HasFrequency<P> && !ConstantFrequency<P>) {
          const Lanes here(problems_[j].frequency_squared(position(y)));
          seen.turn[j] = select(here > seen.turn[j], here, seen.turn[j]);
        }
        if constexpr (QuadraticContact<P>)
          seen.lowest[j] = select(y.action.s < seen.lowest[j], y.action.s, seen.lowest[j]);
        if constexpr (HasDomain<P>) seen.left[j] = seen.left[j] | !(problems_[j].inside(position(y)) >= Lanes(0));
        y.t = t;
        assign(x[j], y);
      }
    }
  }
  void keep() override { kept_ = steppers_; }
  void take_back() override { steppers_ = kept_; }
  void take_lane(GroupSteps<P, X>& other, std::size_t from_pack, std::size_t from, std::size_t pack,
                 std::size_t lane) override {
    std::array<double, 2 * X::size> kept;  // NOLINT: written before it is read
    std::size_t out = 0, in = 0;
    static_cast<BoundGroup&>(other).steppers_[from_pack].each_kept([&](const Lanes& x) { kept[out++] = x.v[from]; });
    steppers_[pack].each_kept([&](Lanes& x) { x.v[lane] = kept[in++]; });
  }
  Work work() const override { return steppers_[0].work(); }

 private:
  using Stepper = StepperOf<Scheme, P, X>;
  template <std::size_t... J>
  Group<Stepper> bind(const Group<X>& x, std::index_sequence<J...>) const {
    return {scheme_.bind(problems_[J], x[J])...};
  }

  Scheme scheme_;
  Group<P> problems_;
  Group<Stepper> steppers_, kept_;
};

}  // namespace least
