// What a diagnostic is: one row of the table in table.hpp. A row is a type with
//   info               its card
//   sees               what it sees of a run
//   applies<P>         whether it means something on a scene
//   Seen<P, X>         a value, so that a block of steps can be taken back; where it sees every step
//                        start(problem, x) or start(problem, x, tangents of steps), see(problem, x);
//                        look(problem, x) where it also looks at states within long steps, look_again() to do so
//                        where the run ends within one
//                      and in every case
//                        report(end) → Report, asked once, when the run is over
// A new diagnostic is its row and a line in the table; the catalogue, the decoder and the page follow.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/run/diagnostics/events.hpp"
#include "core/run/diagnostics/largest_error.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "core/run/tangent.hpp"

namespace least {

/// What a diagnostic sees of a run before its end.
enum class Sees : std::uint8_t {
  nothing,
  every_step,
  sections,  ///< the changes of sign of the scene's sections, located
  states,    ///< some whole states along the run
};

/// What a run leaves to its diagnostics.
template <class P, class X>
struct RunEnd {
  using Full = FullStateOf<P>;
  const P& problem;
  const Scene& scene;
  const Request& request;
  const SchemeCard& scheme;
  const X& x;                       ///< the final state
  const std::vector<Full>& states;  ///< kept along the run, where a diagnostic sees states
  const Events& events;             ///< found along the run, where a diagnostic sees sections
  /// Derivatives of a step from a state; empty where there are none.
  std::function<std::optional<Tangent<Full>>(const Full&)> tangent;
  /// The same on the extended space, for schemes whose steps are contact maps there.
  std::function<std::optional<ExtendedStepOf<P>>(const Full&)> extended_tangent;
  TimeLeft left;
  std::vector<Warning>& warnings;  ///< what a report cannot say
};

}  // namespace least
