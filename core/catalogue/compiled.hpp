// A problem of the catalogue as mechanics: made by the compiler from its description and the list of schemes. Steps are
// compiled elsewhere, with more optimisation: core/catalogue/pairs.hpp, which one unit per problem has to instantiate.
#pragma once

#include <functional>
#include <optional>
#include <tuple>

#include "core/from_values.hpp"
#include "core/reference/blow_up.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/regular_state.hpp"
#include "core/run/run.hpp"
#include "core/run/scales.hpp"
#include "core/schemes/list.hpp"

namespace least {

/// The cards of all schemes, in the order of the list.
std::span<const SchemeCard> scheme_cards();

/// Whether the caller asks for what only the full state can say: s or what depends on it, a slope or its poles.
inline bool asks_for_full_state(const ProblemCard& card, const Request& request) {
  return request.watched.full_state() ||
         std::ranges::any_of(request.columns, [&](std::size_t i) { return request.column(i).full_state; }) ||
         std::ranges::any_of(request.diagnostics, [&](std::size_t i) { return card.diagnostics[i].full_state; });
}

template <class Scheme, class P>
concept Fits = FixedStepSchemeFor<Scheme, P> || SelfTimedSchemeFor<Scheme, P>;

/// Calls f with the scheme of a request, which fits.
template <class P, class F, class... Scheme>
void with_scheme(const Request& request, F&& f, std::tuple<Scheme...>*) {
  std::size_t i = 0;
  const auto called = [&]<class S>(S*) {
    if (i++ != request.scheme) return false;
    if constexpr (Fits<S, P>) f(from_values<S>(S::fields, request.settings));
    return true;
  };
  (called(static_cast<Scheme*>(nullptr)) || ...);
}
template <class P, class F>
void with_scheme(const Request& request, F&& f) {
  with_scheme<P>(request, f, static_cast<SchemeList*>(nullptr));
}

/// Tangents of the steps of a run, whichever state it carries: they are of the full one.
template <class P>
StepTangents<P> tangents_of(const P& problem, const Request& request) {
  using Full = FullStateOf<P>;
  StepTangents<P> tangents{[](const Full&, const ActiveMethod&) { return std::nullopt; },
                           [](const Full&) { return std::nullopt; }};
  if (!request.until_steps) tangents.end = request.end;
  if (request.diagnostics.empty()) return tangents;  // nobody asks for them
  const Full start = start_of<Full>(problem, request.scene->initial, request.scene->start);
  with_scheme<P>(request, [&]<class Scheme>(const Scheme& scheme) {
    if constexpr (ExtendsTo<Scheme, P>) {
      tangents.extended = [&problem, scheme, start](const Full& x) {
        return extended_step_tangent(scheme, problem, start, x);
      };
    } else if constexpr (!AdaptsSteps<Scheme>) {
      tangents.plain = [&problem, scheme, start](const Full& x, const ActiveMethod& before) {
        return step_tangent(scheme, problem, start, x, before);
      };
      tangents.level = level_slopes(scheme, problem, start);
    }
  });
  return tangents;
}

template <class X, class P>
Solution solve(const P& problem, const Request& request, const std::vector<Column<P, X>>& columns, RowSink& sink,
               const std::atomic<bool>& cancelled) {
  const X start = start_of<X>(problem, request.scene->initial, request.scene->start);
  return Run<P, X>(problem, request, columns, sink, cancelled).solve(start, tangents_of(problem, request));
}

template <class P>
std::string offers() {
  std::string words = Separable<P>             ? "a separable Hamiltonian (a potential and a constant kinetic metric)"
                      : LinearContact<P>       ? "a contact Hamiltonian linear in s (a potential and a damping)"
                      : QuadraticContact<P>    ? "a contact Hamiltonian quadratic in s"
                      : ConfigurationMetric<P> ? "a Lagrangian whose kinetic metric depends on the configuration"
                      : GeneralLagrangian<P>   ? "a regular Lagrangian L(q, v, s, t) of no simpler form"
                      : GeneralHamiltonian<P>  ? "a Hamiltonian H(q, p, s, t) of no simpler form"
                      : SplitFlow<P>           ? "a vector field that is a sum of exact flows"
                                               : "";
  if (VectorField<P>) words += words.empty() ? "equations of motion" : ", equations of motion";
  if (Autonomous<P>) words += " that do not depend on time";
  return words;
}

/// A description with what follows from the mechanics.
template <class P>
ProblemCard complete_card(ProblemCard card) {
  card.keeps_energy = KeepsEnergy<P>;
  card.keeps_form = Potential<P> || GeneralHamiltonian<P>;
  for (const auto& column : columns_of<P, FullRunState<P>>(card)) card.columns.push_back(column.card);
  card.diagnostics = diagnostic_cards<P>();
  card.offers = offers<P>();
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    std::size_t i = 0;
    ((Fits<Scheme, P> ? card.schemes.push_back(i++) : void(++i)), ...);
  }(static_cast<SchemeList*>(nullptr));
  return card;
}

/// Mechanics of one type of problem, which the parameters of a scene make.
template <class P>
class ProblemMechanics : public Mechanics {
  using State = StateOf<P>;
  using Full = FullRunState<P>;

 public:
  explicit ProblemMechanics(ProblemCard described)
      : card_(complete_card<P>(std::move(described))),
        kinds_(kinds_of(card_)),
        columns_(columns_of<P, State>(card_)),
        full_columns_(columns_of<P, Full>(card_)) {}

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return card_.id; }
  std::span<const SchemeCard> schemes() const override { return scheme_cards(); }

  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    const P problem = problem_of(request.scene->parameters);
    if constexpr (!std::is_same_v<State, Full>)
      if (asks_for_full_state(card_, request)) return solve<Full>(problem, request, full_columns_, sink, cancelled);
    return solve<State>(problem, request, columns_, sink, cancelled);
  }
  std::optional<RegularStart> regular_start([[maybe_unused]] std::span<const double> parameters,
                                            [[maybe_unused]] double t) const override {
    if constexpr (HasSeries<P>)
      if (t != 0) return regular_state(problem_of(parameters), t);
    return std::nullopt;
  }
  Scales scales(const Scene& scene) const override {
    const P problem = problem_of(scene.parameters);
    return scales_of(problem, start_of<State>(problem, scene.initial, scene.start));
  }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    const P problem = problem_of(scene.parameters);
    return true_states(problem, start_of<State>(problem, scene.initial, scene.start), times, keep_going, kinds_);
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const P problem = problem_of(scene.parameters);
    return conditioning_of(problem, start_of<State>(problem, scene.initial, scene.start), end, keep_going, kinds_);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const P problem = problem_of(scene.parameters);
    return pace_of(problem, start_of<State>(problem, scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time([[maybe_unused]] const Scene& scene, [[maybe_unused]] double latest, [[maybe_unused]] double step,
                      [[maybe_unused]] const KeepGoing& keep_going) const override {
    if constexpr (QuadraticContact<P>) {
      const P problem = problem_of(scene.parameters);
      return true_blow_up_time(problem, start_of<State>(problem, scene.initial, scene.start), latest, step, keep_going);
    }
    return unknown;
  }

 protected:
  /// The one way from a scene to a problem.
  virtual P problem_of(std::span<const double> parameters) const = 0;

 private:
  ProblemCard card_;
  std::vector<std::size_t> kinds_;  ///< of the variables
  std::vector<Column<P, State>> columns_;
  std::vector<Column<P, Full>> full_columns_;
};

/// A problem of the catalogue.
template <template <class> class P>
class CompiledMechanics final : public ProblemMechanics<P<double>> {
 public:
  CompiledMechanics() : ProblemMechanics<P<double>>(described()) {}

 private:
  static ProblemCard described() {
    ProblemCard card = About<P>::card();
    card.parameters = parameter_cards(About<P>::fields);
    return card;
  }
  P<double> problem_of(std::span<const double> parameters) const override {
    return from_values<P<double>>(About<P>::fields, parameters);
  }
};

}  // namespace least
