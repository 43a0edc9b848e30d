// The clock of members that share step, times and parameters: they share what a step needs of its times, too. The pack
// of lanes that comes first makes it, the others take it. Only units of lanes include this header.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>

#include "core/composition.hpp"
#include "core/phases.hpp"

namespace least {

/// While it lives, the clocks that are made by its thread are those of members that go in step. A stepper has one clock
/// at most: what is shared is of one kind.
class GroupOfClocks {
 public:
  GroupOfClocks() { current_ = this; }
  ~GroupOfClocks() { current_ = nullptr; }
  GroupOfClocks(const GroupOfClocks&) = delete;
  GroupOfClocks& operator=(const GroupOfClocks&) = delete;

  /// What they share; outside of any group one's own, and for another kind than the first, too.
  template <class Shared>
  static std::shared_ptr<Shared> join() {
    auto made = std::make_shared<Shared>();
    if (!current_) return made;
    if (current_->kind_ == &kind_of<Shared>) return std::static_pointer_cast<Shared>(current_->shared_);
    if (current_->kind_) return made;
    current_->kind_ = &kind_of<Shared>;
    current_->shared_ = made;
    return made;
  }

 private:
  template <class Shared>
  static constexpr char kind_of = 0;
  static constinit inline thread_local GroupOfClocks* current_ = nullptr;

  const char* kind_ = nullptr;
  std::shared_ptr<void> shared_;
};

/// A problem's own clock under another name.
template <class P>
struct ByItself : P {
  explicit ByItself(const P& problem) : P(problem) {}
};
/// Whether it costs more to make an entry than to look it up.
template <class P>
concept CostlyTimes = HasPhases<P> ||(LinearContact<P> && !ConstantDamping<P>);

template <class Entry, template <class> class P>
requires CostlyTimes<P<double>>
class PhaseClock<Entry, P<double>, double> {
 public:
  template <class Make>
  PhaseClock(const P<double>& problem, double start, double step, std::span<const double> nodes, Make&& make)
      : made_(GroupOfClocks::join<Made>()) {
    if (!made_->first) made_->first.emplace(ByItself(problem), start, step, nodes, make);
    own_ = made_->first;
  }

  void begin(double t, double h) noexcept {
    own_->begin(t, h);
    if (made_->t == t && made_->h == h) return;
    made_->t = t;
    made_->h = h;
    made_->count = 0;
  }
  template <class Make>
  Entry at(std::size_t i, double t, Make&& make) const {
    return own_->at(i, t, [&](double time) {
      if (i < made_->count) return made_->entries[i];
      const Entry entry = make(time);
      if (i == made_->count) made_->entries[made_->count++] = entry;
      return entry;
    });
  }

 private:
  using Own = PhaseClock<Entry, ByItself<P<double>>, double>;
  /// The clock at the start, and of the step of the length h from t the entries of its first nodes.
  struct Made {
    std::optional<Own> first;
    double t = std::numeric_limits<double>::quiet_NaN(), h = t;
    std::size_t count = 0;
    std::array<Entry, compositions::most_stages> entries{};
  };

  std::optional<Own> own_;  ///< always there
  std::shared_ptr<Made> made_;
};

}  // namespace least
