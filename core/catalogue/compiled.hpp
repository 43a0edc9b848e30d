// A problem of the catalogue as mechanics, which the compiler makes from its description and the list of schemes. Steps
// are compiled elsewhere, with more optimisation: core/catalogue/pairs.hpp, which one unit per problem has to
// instantiate.
#pragma once

#include <functional>
#include <optional>
#include <tuple>
#include <type_traits>

#include "core/catalogue/equation_steps.hpp"
#include "core/catalogue/recorded_tangents.hpp"
#include "core/from_values.hpp"
#include "core/reference/blow_up.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/regular_state.hpp"
#include "core/run/diagnostics/table.hpp"
#include "core/run/integrator.hpp"
#include "core/run/problem_entries.hpp"
#include "core/run/run.hpp"
#include "core/run/scales.hpp"
#include "core/run/tangent.hpp"
#include "core/schemes/list.hpp"

namespace least {

/// The cards of all schemes, in the order of the list.
std::span<const SchemeCard> scheme_cards();

/// asks_for_full_state returns whether a request needs the full state: s or quantities that depend on it, a slope or
/// its poles.
inline bool asks_for_full_state(const ProblemCard& card, const Request& request) {
  return request.watched.full_state() ||
         std::ranges::any_of(request.columns, [&](std::size_t i) { return request.column(i).full_state; }) ||
         std::ranges::any_of(request.diagnostics, [&](std::size_t i) { return card.diagnostics[i].full_state; });
}

/// Fits: a scheme runs a problem, either compiled for it or with its equations of motion alone.
template <class Scheme, class P>
concept Fits = OnEquations<Scheme> || FixedStepSchemeFor<Scheme, P> || SelfTimedSchemeFor<Scheme, P>;

/// with_scheme calls f with the scheme of a request, if it fits the problem.
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

/// full_state_from returns the full state with the components of a run's state; components that the run does not carry
/// are 0.
template <class P>
FullStateOf<P> full_state_from(const RunState& x) {
  FullStateOf<P> full{};
  full.t = x.t;
  for (std::size_t i = 0; i < std::min(FullStateOf<P>::size, x.size()); ++i) full[i] = x[i];
  return full;
}

/// tangents_of returns the tangents of the steps of a run from `start`, always those of the full state. The problem has
/// to outlive them.
template <class P>
StepTangents tangents_of(const P& problem, const Request& request, const FullStateOf<P>& start) {
  using Full = FullStateOf<P>;
  StepTangents tangents;
  if (!request.until_steps) tangents.end = request.end;
  with_scheme<P>(request, [&]<class Scheme>(const Scheme& scheme) {
    if constexpr (ExtendsTo<Scheme, P>) {
      tangents.extended = [&problem, scheme, start](const RunState& x, const KeepGoing& keep_going, TangentMap& map) {
        const auto step = extended_step_tangent(scheme, problem, start, full_state_from<P>(x), keep_going);
        if (step) map = tangent_map(step->start, step->tangent);
        map.extended = true;
        return step.has_value();
      };
    } else if constexpr (!AdaptsSteps<Scheme>) {
      tangents.plain = [&problem, scheme, start](const RunState& x, const KeepGoing& keep_going, TangentMap& map) {
        const Full from = full_state_from<P>(x);
        const auto tangent = step_tangent(scheme, problem, start, from, keep_going);
        if (tangent) map = tangent_map(from, *tangent);
        return tangent.has_value();
      };
      tangents.along = [&problem, scheme, start](const RunState& x, const ActiveMethod& before, const StateNumbers& u,
                                                 double dt, double level, ChangeOfStep& to) {
        Vec<int(Full::size)> direction{};
        std::copy_n(u.begin(), std::min(u.size(), direction.size()), direction.begin());
        const auto found = step_change(scheme, problem, start, full_state_from<P>(x), before, direction, dt, level);
        if (!found) return false;
        assign_numbers(found->image, to.to);
        to.change.assign(found->change.data(), found->change.data() + found->change.size());
        to.longer = found->longer;
        to.course = found->course;
        return true;
      };
      const auto level = level_slopes(scheme, problem, start);
      tangents.level.assign(level.begin(), level.end());
    }
  });
  return tangents;
}

/// complete_card adds to a description what follows from the mechanics; `schemes` are the indices of those that fit.
ProblemCard complete_card(ProblemCard card, const ProblemTraits& traits, std::vector<std::size_t> schemes);
/// columns_of, compiled once.
std::vector<Column> all_columns(const ProblemTraits& traits, const ProblemCard& card);

template <class P>
std::vector<std::size_t> fitting_schemes() {
  std::vector<std::size_t> fitting;
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    std::size_t i = 0;
    ((Fits<Scheme, P> ? fitting.push_back(i++) : void(++i)), ...);
  }(static_cast<SchemeList*>(nullptr));
  return fitting;
}

/// bind_scheme returns the scheme of a request bound to the problem, as an integrator of states X. It is defined in
/// core/catalogue/pairs.hpp and compiled in a unit of its own, since steps deserve optimisation that the code around
/// them does not.
template <class P, class X>
std::unique_ptr<Integrator> bind_scheme(const RunBackend& backend, const P& problem, const Request& request,
                                        const RunState& x, const Grid& grid, double end);

/// CompiledBackend is the RunBackend of a problem for runs with states X.
template <class P, class X>
class CompiledBackend final : public RunBackend {
  using State = StateOf<P>;

 public:
  explicit CompiledBackend(const P& problem) : motion_(problem), table_(problem) {}

  const ProblemTable& table() const override {
    if constexpr (lean) return motion_;
    if constexpr (!lean) return table_;
  }
  const ProblemTable& motion() const override { return motion_; }
  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid,
                                   double end) const override {
    if (scheme_cards()[request.scheme].id == Taylor::id) {
      const auto scheme = from_values<Taylor>(Taylor::fields, request.settings);
      return bind_taylor(*this, taylor::expansion_of<X>(problem(), scheme.tolerance, scheme.order), x, end);
    }
    return bind_scheme<P, X>(*this, problem(), request, x, grid, end);
  }
  StepTangents tangents(const Request& request) const override {
    if constexpr (Flow<P>) {
      const Scene& scene = *request.scene;
      return tangents_of(problem(), request, start_of<FullStateOf<P>>(problem(), scene.initial, scene.start));
    } else {
      return recorded_tangents(request);
    }
  }

  std::vector<tape::Index> write_equations(tape::Tape& tape) const override {
    const auto rates = taylor::write_equations<State>(problem(), tape);
    return {rates.begin(), rates.end()};
  }
  std::size_t found() const override { return 0; }
  void values_of(StateView x, double* values) const override {
    std::ranges::copy(taylor::values_of(state_from<State>(x)), values);
  }
  void values_of(StateView x, const double* u, double* values, double* slopes) const override {
    for (const Slope& value : taylor::values_of(moved(x, u))) {
      *values++ = value.value;
      *slopes++ = value.slope[0];
    }
  }
  std::shared_ptr<const tape::SteepForces> steep_forces() const override { return least::steep_forces(problem()); }

  void velocity(StateView x, double* v) const override {
    if constexpr (!Flow<P>) std::ranges::copy(velocity_at(state_from<State>(x)), v);
  }
  void velocity_slopes(StateView x, const double* u, double* slopes) const override {
    if constexpr (!Flow<P>)
      for (const Slope& v : velocity_at(moved(x, u))) *slopes++ = v.slope[0];
  }
  bool has_component(std::size_t i) const override { return least::has_component(problem(), i); }
  bool has_closed_form(StateView x) const override { return least::has_closed_form(problem(), state_from<State>(x)); }
  double energy_after(StateView x, double t) const override {
    if constexpr (Contact<P>) {
      using Full = FullStateOf<P>;
      Extrapolation<P, Full> flow(problem(), state_from<Full>(x), 1e-14, t - x.t);
      int patience = 20;
      if (flow.advance(t, [&] { return --patience > 0; })) return energy(problem(), flow.state());
    }
    return unknown;
  }

 private:
  const P& problem() const { return motion_.problem(); }
  /// moved returns a state in dual numbers with the derivative u.
  static auto moved(StateView x, const double* u) {
    auto y = convert<Slope, double>(state_from<State>(x));
    for (std::size_t i = 0; i < State::size; ++i) y[i].slope[0] = u[i];
    return y;
  }
  template <class Y>
  auto velocity_at(const Y& x) const {
    if constexpr (Potential<P>) {
      return least::velocity(problem(), x.q, x.p);
    } else {
      return problem().slopes(x.q, x.p, x.action.s, phase(problem(), x.t)).by_p;
    }
  }

  static constexpr bool lean = std::is_same_v<X, State>;
  struct SameTable {
    explicit SameTable(const P&) {}
  };

  ProblemEntries<P, State> motion_;
  [[no_unique_address]] std::conditional_t<lean, SameTable, ProblemEntries<P, X>> table_;
};

/// ProblemMechanics is the mechanics of one type of problem, which problem_of makes from the parameters of a scene.
template <class P>
class ProblemMechanics : public Mechanics {
  using State = StateOf<P>;
  using Full = FullRunState<P>;

 public:
  explicit ProblemMechanics(ProblemCard described)
      : card_(complete_card(std::move(described), ProblemEntries<P, Full>::known, fitting_schemes<P>())),
        kinds_(kinds_of(card_)),
        columns_(all_columns(ProblemEntries<P, Full>::known, card_)) {}

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return card_.id; }
  std::span<const SchemeCard> schemes() const override { return scheme_cards(); }

  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    return with_backend(request, [&]<class Backend>(std::type_identity<Backend>, const P& problem) {
      return least::run(Backend(problem), request, columns_, sink, cancelled);
    });
  }
  std::unique_ptr<const RunBackend> backend(const Request& request) const override {
    return with_backend(request, []<class Backend>(std::type_identity<Backend>, const P& problem) {
      return std::unique_ptr<const RunBackend>(std::make_unique<const Backend>(problem));
    });
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
    const CompiledBackend<P, State> backend(problem_of(scene.parameters));
    return conditioning_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going, kinds_);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const CompiledBackend<P, State> backend(problem_of(scene.parameters));
    return pace_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time([[maybe_unused]] const Scene& scene, [[maybe_unused]] double latest, [[maybe_unused]] double step,
                      [[maybe_unused]] const KeepGoing& keep_going) const override {
    if constexpr (QuadraticContact<P>) {
      const CompiledBackend<P, State> backend(problem_of(scene.parameters));
      return true_blow_up_time(backend, backend.motion().start(scene.initial, scene.start), latest, step, keep_going);
    }
    return unknown;
  }

 protected:
  /// The problem with the parameters of a scene.
  virtual P problem_of(std::span<const double> parameters) const = 0;

 private:
  /// Calls f with the type of backend that carries what a request asks for, and with the problem.
  template <class F>
  auto with_backend(const Request& request, F&& f) const {
    const P problem = problem_of(request.scene->parameters);
    if constexpr (!std::is_same_v<State, Full>)
      if (asks_for_full_state(card_, request)) return f(std::type_identity<CompiledBackend<P, Full>>(), problem);
    return f(std::type_identity<CompiledBackend<P, State>>(), problem);
  }

  ProblemCard card_;
  std::vector<std::size_t> kinds_;  ///< kinds of the variables (kinds_of)
  std::vector<Column> columns_;
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
