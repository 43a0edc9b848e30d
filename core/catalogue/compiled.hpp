// A problem of the catalogue as mechanics: made by the compiler from its description and the list of schemes.
#pragma once

#include <array>
#include <tuple>

#include "core/from_values.hpp"
#include "core/reference/blow_up.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/regular_state.hpp"
#include "core/run/fixed_step.hpp"
#include "core/run/run.hpp"
#include "core/run/self_timed.hpp"
#include "core/schemes/list.hpp"

namespace least {

/// The cards of all schemes, in the order of the list.
std::span<const SchemeCard> scheme_cards();

/// The one way from a scene to a problem.
template <template <class> class P>
P<double> problem_of(const Scene& scene) {
  return from_values<P<double>>(About<P>::fields, scene.parameters);
}

/// Whether the caller asks for what only the full state can say: s or what depends on it, a slope or its poles.
inline bool asks_for_full_state(const ProblemCard& card, const Request& request) {
  return std::ranges::any_of(request.columns, [&](std::size_t i) { return card.columns[i].full_state; }) ||
         std::ranges::any_of(request.diagnostics, [&](std::size_t i) { return card.diagnostics[i].full_state; });
}

/// Schemes that differ in nothing that has to be compiled are run as one.
template <class Scheme>
auto compiled_scheme(const Scheme& scheme) {
  if constexpr (requires { scheme.compiled_as(); }) {
    return scheme.compiled_as();
  } else {
    return scheme;
  }
}

template <class X, class P, class Scheme>
Solution solve(const P& problem, const Scheme& scheme, const Request& request, RowSink& sink,
               const std::atomic<bool>& cancelled) {
  const X x = start_of<X>(problem, request.scene->initial, request.scene->start);
  if constexpr (SelfTimed<Scheme>) {
    Run<P, X> run(problem, request, std::nullopt, sink, cancelled);
    SelfTimedIntegrator<P, Scheme, X> integrator(problem, scheme, x, run.end());
    return run.solve(integrator, x);
  } else {
    Run<P, X> run(problem, request, scheme.step, sink, cancelled);
    FixedStepIntegrator<P, Scheme, X> integrator(problem, scheme, x, run.grid());
    return run.solve(integrator, x);
  }
}

template <template <class> class P, class Scheme>
Solution run_pair(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) {
  const auto problem = problem_of<P>(*request.scene);
  const auto scheme = compiled_scheme(from_values<Scheme>(Scheme::fields, request.settings));
  using Motion = StateOf<P<double>>;
  using Full = FullRunState<P<double>>;
  if constexpr (!std::is_same_v<Motion, Full>)
    if (asks_for_full_state(request.scene->card(), request))
      return solve<Full>(problem, scheme, request, sink, cancelled);
  return solve<Motion>(problem, scheme, request, sink, cancelled);
}

using RunFunction = Solution (*)(const Request&, RowSink&, const std::atomic<bool>&);
template <template <class> class P, class Scheme>
constexpr RunFunction run_function() {
  if constexpr (FixedStepSchemeFor<Scheme, P<double>> || SelfTimedSchemeFor<Scheme, P<double>>) {
    return &run_pair<P, Scheme>;
  } else {
    return nullptr;  // the pair does not exist
  }
}
template <template <class> class P, class... Scheme>
constexpr auto run_functions(std::tuple<Scheme...>*) {
  return std::array{run_function<P, Scheme>()...};
}

template <class P>
std::string offers() {
  std::string words = Separable<P>             ? "a separable Hamiltonian (a potential and a constant kinetic metric)"
                      : LinearContact<P>       ? "a contact Hamiltonian linear in s (a potential and a damping)"
                      : QuadraticContact<P>    ? "a contact Hamiltonian quadratic in s"
                      : ConfigurationMetric<P> ? "a Lagrangian whose kinetic metric depends on the configuration"
                      : SplitFlow<P>           ? "a vector field that is a sum of exact flows"
                                               : "";
  if (VectorField<P>) words += ", equations of motion";
  if (Autonomous<P>) words += " that do not depend on time";
  return words;
}

/// A description with what follows from the mechanics.
template <template <class> class P>
ProblemCard complete_card() {
  ProblemCard card = About<P>::card();
  card.parameters = parameter_cards(About<P>::fields);
  card.keeps_energy = KeepsEnergy<P<double>>;
  card.keeps_form = Potential<P<double>>;
  for (const auto& column : columns_of<P<double>, FullRunState<P<double>>>(card)) card.columns.push_back(column.card);
  card.diagnostics = diagnostic_cards<P<double>>();
  card.offers = offers<P<double>>();
  std::size_t i = 0;
  for (const RunFunction run : run_functions<P>(static_cast<SchemeList*>(nullptr))) {
    if (run) card.schemes.push_back(i);
    ++i;
  }
  return card;
}

template <template <class> class P>
class CompiledMechanics final : public Mechanics {
 public:
  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return card_.id; }
  std::span<const SchemeCard> schemes() const override { return scheme_cards(); }

  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    static constexpr auto runs = run_functions<P>(static_cast<SchemeList*>(nullptr));
    return runs.at(request.scheme)(request, sink, cancelled);
  }
  std::optional<RegularStart> regular_start([[maybe_unused]] std::span<const double> parameters,
                                            [[maybe_unused]] double t) const override {
    if constexpr (HasSeries<Problem>)
      if (t != 0) return regular_state(from_values<Problem>(About<P>::fields, parameters), t);
    return std::nullopt;
  }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    const Problem problem = problem_of<P>(scene);
    return true_states(problem, start_of<State>(problem, scene.initial, scene.start), times, keep_going);
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const Problem problem = problem_of<P>(scene);
    return conditioning_of(problem, start_of<State>(problem, scene.initial, scene.start), end, keep_going);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const Problem problem = problem_of<P>(scene);
    return pace_of(problem, start_of<State>(problem, scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time([[maybe_unused]] const Scene& scene, [[maybe_unused]] double latest, [[maybe_unused]] double step,
                      [[maybe_unused]] const KeepGoing& keep_going) const override {
    if constexpr (QuadraticContact<Problem>) {
      const Problem problem = problem_of<P>(scene);
      return true_blow_up_time(problem, start_of<State>(problem, scene.initial, scene.start), latest, step, keep_going);
    }
    return unknown;
  }

 private:
  using Problem = P<double>;
  using State = StateOf<Problem>;
  ProblemCard card_ = complete_card<P>();
};

}  // namespace least
