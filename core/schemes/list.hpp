// Every scheme there is: a new one is its header and a line here.
#pragma once

#include <tuple>

#include "core/schemes/galerkin_4.hpp"
#include "core/schemes/runge_kutta.hpp"
#include "core/schemes/splitting.hpp"
#include "core/schemes/variational_midpoint.hpp"

namespace least {

using SchemeList = std::tuple<ExplicitEuler, ExplicitMidpoint, RungeKutta4, Ruth3, SymplecticEuler, Leapfrog,
                              VariationalMidpoint, Galerkin4>;

}  // namespace least
