// The shared clock of members that have step, times and parameters in common: time-dependent quantities of a step are
// computed by the first pack of lanes that needs them, and reused by the others. Only the lane units include this
// header.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/composition.hpp"
#include "core/phases.hpp"

namespace least {

/// GroupOfClocks: while it lives, all clocks made by its thread belong to members that begin together and advance
/// together, none more than `stretch` steps ahead of another. A stepper has at most one clock, so that one kind of
/// Shared suffices.
class GroupOfClocks {
 public:
  static constexpr std::int64_t stretch = 250;

  GroupOfClocks() { current_ = this; }
  ~GroupOfClocks() { current_ = nullptr; }
  GroupOfClocks(const GroupOfClocks&) = delete;
  GroupOfClocks& operator=(const GroupOfClocks&) = delete;

  struct Shared {
    virtual ~Shared() = default;
  };
  /// join(make) returns the shared part, which the first caller makes.
  template <class Make>
  static auto* join(Make&& make) {
    using Made = typename decltype(make())::element_type;
    assert(current_);
    if (!current_->shared_) current_->shared_ = make();
    return static_cast<Made*>(current_->shared_.get());
  }

 private:
  static constinit inline thread_local GroupOfClocks* current_ = nullptr;

  std::unique_ptr<Shared> shared_;
};

/// UnsharedClock wraps a problem to select the ordinary PhaseClock, which does not share.
template <class P>
struct UnsharedClock : P {
  explicit UnsharedClock(const P& problem) : P(problem) {}
};
/// CostlyTimes: making an entry costs more than looking it up. Scenes with γs²/2 are excluded: their steps may end
/// early for some members, and entries that others need would be missing.
template <class P>
concept CostlyTimes = !QuadraticContact<P> && (HasPhases<P> || (LinearContact<P> && !ConstantDamping<P>));

template <class Entry, template <class> class P>
requires CostlyTimes<P<double>>
class PhaseClock<Entry, P<double>, double> {
 public:
  template <class Make>
  PhaseClock(const P<double>& problem, double start, double step, std::span<const double> nodes, Make&& make)
      : made_(GroupOfClocks::join([&] {
          return std::make_unique<Made>(Own(UnsharedClock(problem), start, step, nodes, make), start, step,
                                        nodes.size());
        })) {}

  void begin(double t, double h) noexcept {
    if (t != made_->t || h != made_->h) made_->turn_to(t, h);
  }
  template <class Make>
  Entry at(std::size_t i, double t, Make&& make) const {
    return i < made_->row->count ? made_->row->entries[i] : made_->add(i, t, make);
  }

 private:
  using Own = PhaseClock<Entry, UnsharedClock<P<double>>, double>;
  /// The table has rows for the latest steps, and one more for a step off the grid, as it is shorter.
  static constexpr std::uint64_t rows = 256;
  static_assert(rows >= GroupOfClocks::stretch + 1);

  struct Made final : GroupOfClocks::Shared {
    struct Row {
      double t = std::numeric_limits<double>::quiet_NaN();
      std::uint64_t count = 0;
      Entry* entries = nullptr;
    };
    Made(Own&& first, double begin, double length, std::size_t nodes)
        : own(std::move(first)), start(begin), step(length), all((rows + 1) * nodes) {
      for (std::size_t i = 0; i <= rows; ++i) table[i].entries = all.data() + i * nodes;
    }
    Made(const Made&) = delete;
    Made& operator=(const Made&) = delete;

    [[gnu::noinline]] void turn_to(double time, double length) {
      t = time;
      h = length;
      row = &table[rows];
      if (h == step) {
        const auto n = static_cast<std::uint64_t>(std::llround((t - start) / step));
        if (n == end) {
          own.begin(t, h);
          ++end;
        }
        if (end - n - 1 < rows) row = &table[n % rows];
      }
      if (row->t == t && row != &table[rows]) return;
      row->t = t;
      row->count = 0;
    }
    template <class Make>
    [[gnu::noinline]] Entry add(std::size_t i, double time, Make&& make) {
      assert(row == &table[rows] || row == &table[(end - 1) % rows]);  // the own clock is at that step
      const Entry entry = row == &table[rows] ? make(time) : own.at(i, time, make);
      if (i == row->count) row->entries[row->count++] = entry;
      return entry;
    }

    double t = std::numeric_limits<double>::quiet_NaN(), h = t;  ///< of the current step
    Row* row = nullptr;                                          ///< entries of the current step

    Own own;
    double start, step;
    std::uint64_t end = 0;  ///< steps that have had a row
    std::array<Row, rows + 1> table;
    std::vector<Entry> all;
  };

  Made* made_;
};

}  // namespace least
