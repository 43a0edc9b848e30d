// An entry of the catalogue, made by the compiler from a problem's description and the list of schemes.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "core/run/drive.hpp"
#include "core/schemes/list.hpp"

namespace least {

using RunFunction = Outcome (*)(const ProblemCard&, const Request&, Sink&, const std::atomic<bool>&);

struct ProblemEntry {
  ProblemCard card;
  std::vector<RunFunction> runs;  ///< by scheme; null: the pair does not exist
};

/// Every problem, sorted by id; the build generates it from the folder core/problems.
std::span<const ProblemEntry* const> problem_entries();

/// An aggregate with the values of a card's parameters.
template <class C, class Fields>
C assemble(const Fields& fields, std::span<const double> values) {
  C c;
  std::apply(
      [&](const auto&... field) {
        std::size_t i = 0;
        (field.set(c, values[i++]), ...);
      },
      fields);
  return c;
}

template <class Fields>
std::vector<ParameterCard> parameter_cards(const Fields& fields) {
  return std::apply([](const auto&... field) { return std::vector<ParameterCard>{field.card()...}; }, fields);
}

template <template <class> class P, class Scheme>
Outcome run_pair(const ProblemCard& card, const Request& request, Sink& sink, const std::atomic<bool>& cancelled) {
  const auto problem = assemble<P<double>>(About<P>::fields, request.parameters);
  const auto scheme = assemble<Scheme>(Scheme::fields, request.settings);
  return Drive<P<double>, Scheme>(problem, scheme, card, request, sink, cancelled).run();
}

template <template <class> class P, class Scheme>
constexpr RunFunction run_function() {
  if constexpr (SchemeFor<Scheme, P<double>>) {
    return &run_pair<P, Scheme>;
  } else {
    return nullptr;
  }
}

template <class P>
std::string offers() {
  std::string words = Separable<P>             ? "a separable Hamiltonian (a potential and a constant kinetic metric)"
                      : ConfigurationMetric<P> ? "a Lagrangian whose kinetic metric depends on the configuration"
                                               : "";
  if (VectorField<P>) words += ", equations of motion";
  return words;
}

template <template <class> class P>
ProblemEntry make_entry() {
  ProblemEntry entry{About<P>::card(), {}};
  ProblemCard& card = entry.card;
  card.parameters = parameter_cards(About<P>::fields);
  card.keeps_energy = Potential<P<double>>;
  card.columns = column_names(card);
  card.diagnostics = {"energy", "momenta", "structure", "error"};
  if (TwoBody<P<double>>) card.diagnostics.emplace_back("orbit");
  card.offers = offers<P<double>>();
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (entry.runs.push_back(run_function<P, Scheme>()), ...);
  }(static_cast<SchemeList*>(nullptr));
  for (std::size_t i = 0; i < entry.runs.size(); ++i)
    if (entry.runs[i]) card.schemes.push_back(i);
  return entry;
}

}  // namespace least
