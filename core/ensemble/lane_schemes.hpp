// The schemes of core/ensemble/lane_task.hpp as types.
#pragma once

#include <tuple>

#include "core/from_values.hpp"
#include "core/schemes/contact_leapfrog.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "core/schemes/contact_symplectic_euler.hpp"
#include "core/schemes/runge_kutta.hpp"
#include "core/schemes/splitting.hpp"

namespace least {

/// In the order of the names in lane_schemes.
using LaneSchemes = std::tuple<ExplicitEuler, ExplicitMidpoint, RungeKutta4, Ruth3, SymplecticEuler, Leapfrog,
                               ContactSymplecticEuler, ContactLeapfrog, ContactSplitting>;

/// with_lane_scheme calls f(scheme) with the scheme at that place of lane_schemes.
template <class F>
void with_lane_scheme(std::size_t place, std::span<const double> settings, F&& f) {
  std::size_t i = 0;
  const auto called = [&]<class Scheme>(Scheme*) {
    if (i++ == place) f(from_values<Scheme>(Scheme::fields, settings));
  };
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (called(static_cast<Scheme*>(nullptr)), ...);
  }(static_cast<LaneSchemes*>(nullptr));
}

}  // namespace least
