// The clock of members that share step, times and parameters: they share what a step needs of its times, too. The pack
// of lanes that comes first makes it, the others take it. Only units of lanes include this header.
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

/// While it lives, the clocks that are made by its thread are those of members that begin together and go in step, none
/// of them by more steps ahead of another than a stretch. A stepper has one clock at most: what is shared is of one
/// kind.
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
  /// What they share, made by the first.
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

/// A problem's own clock under another name.
template <class P>
struct UnsharedClock : P {
  explicit UnsharedClock(const P& problem) : P(problem) {}
};
/// Whether it costs more to make an entry than to look it up. A step of a scene that reads s may end early for some
/// members, and what others need of it would not be there.
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
  /// Of the latest steps; behind them of one that is none of theirs, as it is shorter.
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
      assert(row == &table[rows] || row == &table[(end - 1) % rows]);  // where its own clock is
      const Entry entry = row == &table[rows] ? make(time) : own.at(i, time, make);
      if (i == row->count) row->entries[row->count++] = entry;
      return entry;
    }

    double t = std::numeric_limits<double>::quiet_NaN(), h = t;  ///< of the step that is being made
    Row* row = nullptr;                                          ///< what is known of its times

    Own own;
    double start, step;
    std::uint64_t end = 0;  ///< steps that had a row
    std::array<Row, rows + 1> table;
    std::vector<Entry> all;
  };

  Made* made_;
};

}  // namespace least
