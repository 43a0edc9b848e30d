// Checks of the steps of every scheme on scenes as text: reversal, the energy, independence of what is recorded.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/texts.hpp"

namespace texts {

/// distance() returns the largest difference of components of two states; infinity where their sizes differ.
inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = a.size() == b.size() ? 0 : INFINITY;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::fmax(most, std::abs(a[i] - b[i]));
  return most;
}

inline std::vector<double> parameters_of(const Definition& definition) {
  std::vector<double> parameters;
  for (const auto& parameter : definition.parameters) parameters.push_back(parameter.second);
  return parameters;
}

/// energy_error() returns the largest relative error of the energy along a run.
inline double energy_error(Request request) {
  runs::ask(request, "energy");
  return runs::number(runs::go(request).outcome.diagnostics, "energy/max_rel_error");
}

/// there_and_back() makes `steps` steps of length h and as many back: `away` is how far the state came, `missed` how
/// far from the start it ends.
struct ThereAndBack {
  double away, missed;
};
template <class Stepper>
ThereAndBack there_and_back(Stepper stepper, const std::vector<double>& start, double t, double h, int steps) {
  std::vector<double> x = start;
  stepper.begin(x.data(), t);
  for (int i = 0; i < steps; ++i) EXPECT_EQ(stepper.step(x.data(), t + h * i, h), StepStatus::ok);
  const double away = distance(x, start);
  stepper.begin(x.data(), t + h * steps);
  for (int i = steps; i > 0; --i) EXPECT_EQ(stepper.step(x.data(), t + h * i, -h), StepStatus::ok);
  return {away, distance(x, start)};
}

/// The final state must have the same bits whether a run keeps nothing else, every step, or samples between its steps.
inline void expect_the_same_however_recorded(const Request& last) {
  Request all = last, some = last;
  all.record = {Record::Mode::every, 1, {}};
  some.record = {Record::Mode::samples, 17, {}};
  if (runs::card(some).keeps_energy) runs::ask(some, "energy");
  const auto end = final_of(last);
  EXPECT_EQ(end, final_of(all));
  EXPECT_EQ(end, final_of(some));
}

}  // namespace texts
