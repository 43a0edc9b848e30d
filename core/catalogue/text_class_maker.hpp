// A class of scenes as text with the schemes that are compiled for it: for the unit of each.
#pragma once

#include "core/catalogue/pairs.hpp"
#include "core/catalogue/text_class.hpp"
#include "core/text/scenes.hpp"

namespace least {

template <class P>
P problem_with(const TextClass::Formulas& formulas) {
  P problem;
  problem.formulas = formulas;
  return problem;
}

template <class P>
std::unique_ptr<Integrator> bind_class(const RunBackend& backend, const TextClass::Formulas& formulas,
                                       const Request& request, const RunState& x, const Grid& grid, double end) {
  const P problem = problem_with<P>(formulas);
  if constexpr (!std::is_same_v<StateOf<P>, FullRunState<P>>)
    if (x.size() > 2 * problem.coordinates())
      return bind_scheme<P, FullRunState<P>>(backend, problem, request, x, grid, end);
  return bind_scheme<P, StateOf<P>>(backend, problem, request, x, grid, end);
}

template <class P>
StepTangents tangents_of_class(const TextClass::Formulas& formulas, const Request& request) {
  using Full = FullStateOf<P>;
  const auto problem = std::make_shared<const P>(problem_with<P>(formulas));
  const StateView initial{request.scene->start, request.scene->initial.data()};
  StepTangents made = tangents_of(*problem, request, typed_state<Full>(*problem, initial));
  made = without_room(std::move(made), problem->coordinates(), P::dof, Full::acting);
  return keeping(problem, std::move(made));
}

template <class P>
TextClass make_text_class(std::string_view name) {
  return {name, fitting_schemes<P>(), bind_class<P>, tangents_of_class<P>};
}

}  // namespace least
