// An entry of the catalogue, made by the compiler from a problem's description and the list of schemes.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "core/assemble.hpp"
#include "core/run/clock_session.hpp"
#include "core/run/session.hpp"
#include "core/schemes/list.hpp"
#include "core/study/probe.hpp"

namespace least {

using RunFunction = Outcome (*)(const ProblemCard&, const SchemeCard&, const Request&, Sink&, const std::atomic<bool>&);

struct ProblemEntry {
  ProblemCard card;
  std::vector<RunFunction> runs;  ///< by scheme; null: the pair does not exist
  // What studies ask of the problem itself.
  Truth (*truth)(const Request&, const std::vector<double>& times, const KeepGoing&);
  Conditioning (*conditioning)(const Request&, const KeepGoing&);
};

/// Every problem, sorted by id; the build generates it from the folder core/problems.
std::span<const ProblemEntry* const> problem_entries();

/// Whether the caller asks for what only the full state can say: s or what depends on it, a slope or its poles.
inline bool asks_for_all(const ProblemCard& card, const Request& request) {
  const auto optional = [&](std::size_t column) {
    const std::string_view name = card.columns[column];
    return name == "energy" || (column > 0 && column <= card.variables.size() && card.variables[column - 1].optional);
  };
  const auto deep = [&](std::size_t index) {
    const std::string_view name = card.diagnostics[index];
    return name == "energy" || name == "decay" || name == "volume" || name == "poles";
  };
  return std::ranges::any_of(request.columns, optional) || std::ranges::any_of(request.diagnostics, deep);
}

/// Schemes that differ in nothing that has to be compiled are run as one.
template <class Scheme>
auto common(const Scheme& scheme) {
  if constexpr (requires { scheme.common(); }) {
    return scheme.common();
  } else {
    return scheme;
  }
}

template <class P, class Scheme>
struct Pair {
  P problem;
  Scheme scheme;
  template <class X>
  Outcome run(const ProblemCard& card, const SchemeCard& scheme_card, const Request& request, Sink& sink,
              const std::atomic<bool>& cancelled) const {
    const X x = start_of<X>(problem, request.initial, request.start);
    if constexpr (OwnClock<Scheme>) {
      const auto run = common(scheme);
      ClockBound<P, std::remove_cvref_t<decltype(run)>, X> engine(problem, run, x);
      return ClockSession<P, X>(problem, card, scheme_card, request, sink, cancelled).run(engine, x);
    } else {
      Bound<P, Scheme, X> engine(problem, scheme, x);
      return Session<P, X>(problem, card, scheme_card, request, scheme.step, sink, cancelled).run(engine, x);
    }
  }
};

template <template <class> class P, class Scheme>
Outcome run_pair(const ProblemCard& card, const SchemeCard& scheme_card, const Request& request, Sink& sink,
                 const std::atomic<bool>& cancelled) {
  const Pair<P<double>, Scheme> pair{assemble<P<double>>(About<P>::fields, request.parameters),
                                     assemble<Scheme>(Scheme::fields, request.settings)};
  using Lean = StateOf<P<double>>;
  using Full = FullRunState<P<double>>;
  if constexpr (!std::is_same_v<Lean, Full>)
    if (asks_for_all(card, request)) return pair.template run<Full>(card, scheme_card, request, sink, cancelled);
  return pair.template run<Lean>(card, scheme_card, request, sink, cancelled);
}

template <template <class> class P, class Scheme>
constexpr RunFunction run_function() {
  if constexpr (SchemeFor<Scheme, P<double>> || ClockSchemeFor<Scheme, P<double>>) {
    return &run_pair<P, Scheme>;
  } else {
    return nullptr;
  }
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

template <class P>
std::vector<std::string_view> diagnostic_names() {
  std::vector<std::string_view> names;
  if (HasEnergy<P>) names.emplace_back("energy");
  if (Potential<P>) names.emplace_back("momenta");
  if (Potential<P>) names.emplace_back("structure");
  names.emplace_back("error");
  if (TwoBody<P>) names.emplace_back("orbit");
  if (Contact<P>) names.insert(names.end(), {"decay", "volume"});
  if (HasEntropy<P>) names.emplace_back("entropy");
  if (HasSection<P>) names.emplace_back("zeros");
  if (Oscillates<P>) names.emplace_back("cycle");
  if (CarriesSlope<P>) names.emplace_back("poles");
  if (HasMoments<P>) names.emplace_back("moments");
  return names;
}

/// The regular solution at a time near its singular start, in the order of the card's variables.
template <template <class> class P>
std::optional<std::vector<double>> regular_start(std::span<const double> parameters, double t) {
  if constexpr (HasSeries<P<double>>) {
    if (!(t > 0 && t <= P<double>::series_until)) return std::nullopt;
    const auto problem = assemble<P<double>>(About<P>::fields, parameters);
    const auto x = series_state<FullStateOf<P<double>>>(problem, t);
    std::vector<double> variables;
    for (std::size_t i = 0; i < x.size; ++i) variables.push_back(x[i]);
    return variables;
  } else {
    return std::nullopt;
  }
}

template <template <class> class P>
ProblemEntry make_entry() {
  ProblemEntry entry{About<P>::card(), {}, &truth_of<P>, &conditioning_of<P>};
  ProblemCard& card = entry.card;
  card.parameters = parameter_cards(About<P>::fields);
  card.keeps_energy = KeepsEnergy<P<double>>;
  card.columns = column_names<P<double>>(card);
  card.diagnostics = diagnostic_names<P<double>>();
  card.offers = offers<P<double>>();
  if (HasSeries<P<double>>) card.regular_start = &regular_start<P>;
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (entry.runs.push_back(run_function<P, Scheme>()), ...);
  }(static_cast<SchemeList*>(nullptr));
  for (std::size_t i = 0; i < entry.runs.size(); ++i)
    if (entry.runs[i]) card.schemes.push_back(i);
  return entry;
}

}  // namespace least
