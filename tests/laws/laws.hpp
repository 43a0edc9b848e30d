// The laws, for one problem: LEAST_LAWS(id, Class) makes a suite of tests. The build calls it for every problem of the
// catalogue, so that a new one is examined the day it appears. Laws that need only runs are in pair_laws.cpp, compiled
// once. LEAST_SCHEME_LAWS adds the laws of the schemes, for one problem of each shape that schemes distinguish:
// identity, symmetry, and orders in quad precision; tests/study/orders_test.cpp measures the orders on all other
// problems.
#pragma once

#include "tests/laws/clock_laws.hpp"
#include "tests/laws/lane_laws.hpp"
#include "tests/laws/number_laws.hpp"
#include "tests/laws/run_laws.hpp"
#include "tests/laws/scheme_laws.hpp"

#define LEAST_LAWS(id, Class)                                                                                        \
  TEST(id, CardIsConsistent) { laws::card_is_consistent<least::problems::Class>(#id); }                              \
  TEST(id, EquationsCanBeRecorded) { laws::recorded<least::problems::Class>(true); }                                 \
  TEST(id, LanesPassThroughTheProblem) { laws::lanes_through_problem<least::problems::Class>(); }                    \
  TEST(id, ScenesInLanesMoveAsAlone) { laws::scenes_in_lanes_move_as_alone<least::problems::Class>(); }              \
  TEST(id, ParametersCanBeDual) { laws::parameters_can_be_dual<least::problems::Class>(); }                          \
  TEST(id, ForceIsMinusGradient) { laws::force_is_minus_gradient<least::problems::Class>(); }                        \
  TEST(id, DampingIsTheSlopeOfItsIntegral) { laws::damping_is_the_slope_of_its_integral<least::problems::Class>(); } \
  TEST(id, EquationsAreHamiltons) { laws::equations_are_hamiltons<least::problems::Class>(); }                       \
  TEST(id, InvariantsAreConserved) { laws::invariants_are_conserved<least::problems::Class>(); }                     \
  TEST(id, ClosedFormIsTheMotion) { laws::closed_form_is_the_motion<least::problems::Class>(); }                     \
  TEST(id, RecordingNeverChangesTheRun) { laws::recording_never_changes_the_run<least::problems::Class>(#id); }

#define LEAST_SCHEME_LAWS(id, Class)                                                             \
  TEST(id, SymmetricSchemesReturn) { laws::symmetric_schemes_return<least::problems::Class>(); } \
  TEST(id, NoStepIsTheIdentity) { laws::no_step_is_the_identity<least::problems::Class>(); }     \
  TEST(id, SymmetricClocksReturn) { laws::symmetric_clocks_return<least::problems::Class>(); }   \
  TEST(id, OrderIsAsDeclared) { laws::order_is_as_declared<least::problems::Class>(); }          \
  TEST(id, ClocksHaveTheirOrder) { laws::clocks_have_their_order<least::problems::Class>(); }
