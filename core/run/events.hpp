// What happens between steps: changes of sign of a scene's sections, found on the step's own map over part of a step.
#pragma once

#include <vector>

#include "core/run/engine.hpp"
#include "core/run/root.hpp"

namespace least {

/// Collects the crossings of a run and makes zeros, cycle and poles of them.
template <class P, class X>
class Events {
 public:
  /// Lists grow no longer than `most`.
  explicit Events(std::size_t most) : most_(most) {}

  /// Every change of sign within the step of length h from `before` to `after`; the engine has saved the former.
  void find(const P& problem, const Engine<P, X>& engine, const X& before, const X& after, double h) {
    const auto was = sections(problem, before), is = sections(problem, after);
    for (std::size_t i = 0; i < was.size(); ++i) {
      if ((was[i] < 0) == (is[i] < 0)) continue;
      const double ahead = root([&](double part) { return sections(problem, at(engine, before, part))[i]; }, 0, h);
      add(i, is[i] > 0, at(engine, before, ahead));
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
  /// Something was left out.
  bool full() const { return full_; }

  Report zeros() const { return {"zeros", zeros_}; }
  Report poles() const { return {"poles", poles_}; }
  /// Of the last whole cycle; null before there is one.
  Report cycle() const {
    const bool whole = rises_ > 1;
    return {"cycle", std::vector<Report>{{"period", whole ? period_ : unknown},
                                         {"amplitude", whole ? amplitude_ : unknown},
                                         {"cycles", rises_ > 0 ? static_cast<double>(rises_ - 1) : 0}}};
  }

 private:
  static X at(const Engine<P, X>& engine, const X& before, double ahead) {
    X x = before;
    if (ahead > 0) engine.peek(x, ahead, true);
    x.t = before.t + ahead;
    return x;
  }

  void note(std::vector<double>& list, double t) {
    full_ = full_ || list.size() == most_;
    if (list.size() < most_) list.push_back(t);
  }

  std::size_t most_;
  bool full_ = false;
  std::vector<double> zeros_, poles_;
  std::int64_t rises_ = 0;
  double last_rise_ = 0, period_ = 0, amplitude_ = 0;
};

}  // namespace least
