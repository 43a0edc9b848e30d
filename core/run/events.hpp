// What happens between steps: changes of sign of a scene's sections, found on the step's own map over part of a step.
#pragma once

#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/root.hpp"
#include "core/scene.hpp"

namespace least {

/// Collects the crossings of a run and makes zeros, cycle and poles of them.
template <class P, class X>
class Events {
 public:
  /// Lists grow no longer than `most`.
  explicit Events(std::size_t most) : most_(most) {}

  /// Every change of sign within the step of length h from `before` to `after`; `at(ahead)` is the state in between.
  template <class At>
  void find(const P& problem, const X& before, const X& after, double h, At&& at) {
    const auto was = sections(problem, before), is = sections(problem, after);
    for (std::size_t i = 0; i < was.size(); ++i) {
      if ((was[i] < 0) == (is[i] < 0)) continue;
      add(i, is[i] > 0, at(root([&](double part) { return sections(problem, at(part))[i]; }, 0, h)));
    }
  }
  /// The same from a point of the orbit that is known by other means.
  void add(std::size_t section, bool upwards, const X& x) {
    if (section == 0) note(zeros_, x.t);
    if (section == 0 && upwards) {
      if (rises_++ > 0) period_ = x.t - last_rise_;
      last_rise_ = x.t;
    }
    if (section == 1) amplitude_ = std::abs(value_of(x[0]));
    if (section == 2) note(poles_, x.t);
  }
  /// Whether a list of this length may grow.
  bool room(std::size_t length) {
    full_ = full_ || length >= most_;
    return length < most_;
  }
  /// Something was left out.
  bool full() const { return full_; }

  Report zeros() const { return {"zeros", zeros_}; }
  Report poles() const { return {"poles", poles_}; }
  /// Of the last whole cycle; null before there is one.
  Report cycle() const {
    const bool whole = rises_ > 1;
    return numbers("cycle", {{"period", whole ? period_ : unknown},
                             {"amplitude", whole ? amplitude_ : unknown},
                             {"cycles", rises_ > 0 ? static_cast<double>(rises_ - 1) : 0}});
  }

 private:
  void note(std::vector<double>& list, double t) {
    if (room(list.size())) list.push_back(t);
  }

  std::size_t most_;
  bool full_ = false;
  std::vector<double> zeros_, poles_;
  std::int64_t rises_ = 0;
  double last_rise_ = 0, period_ = 0, amplitude_ = 0;
};

}  // namespace least
