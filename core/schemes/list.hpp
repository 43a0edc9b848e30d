// Every scheme there is: a new one is its header and a line here.
#pragma once

#include <tuple>

#include "core/schemes/adaptive_verlet.hpp"
#include "core/schemes/contact_galerkin_4.hpp"
#include "core/schemes/contact_gauss.hpp"
#include "core/schemes/contact_leapfrog.hpp"
#include "core/schemes/contact_midpoint.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "core/schemes/contact_symplectic_euler.hpp"
#include "core/schemes/energy_momentum.hpp"
#include "core/schemes/galerkin_4.hpp"
#include "core/schemes/hamiltonian_gauss.hpp"
#include "core/schemes/jacobi_maupertuis.hpp"
#include "core/schemes/lifted_splitting.hpp"
#include "core/schemes/odeint.hpp"
#include "core/schemes/runge_kutta.hpp"
#include "core/schemes/splitting.hpp"
#include "core/schemes/taylor.hpp"
#include "core/schemes/time_transformed.hpp"
#include "core/schemes/variational_midpoint.hpp"

namespace least {

using SchemeList =
    std::tuple<ExplicitEuler, ExplicitMidpoint, RungeKutta4, Ruth3, SymplecticEuler, Leapfrog, VariationalMidpoint,
               Galerkin4, JacobiMaupertuis, EnergyMomentum, TimeTransformed, AdaptiveVerlet, ContactSymplecticEuler,
               ContactLeapfrog, ContactVariationalMidpoint, ContactGalerkin4, ContactSplitting, ContactGauss,
               LiftedSplitting, Taylor, DormandPrince5, Fehlberg78, BulirschStoer>;

}  // namespace least
