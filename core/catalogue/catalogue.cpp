#include "core/catalogue/catalogue.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/catalogue/compiled.hpp"
#include "core/run/suggestions.hpp"
#include "core/schemes/text_list.hpp"

namespace least {
namespace {

/// complete_card adds to a scheme's description what follows from its type.
template <class Scheme>
SchemeCard complete_card() {
  SchemeCard card = Scheme::card();
  card.parameters = parameter_cards(Scheme::fields);
  card.own_clock = SelfTimed<Scheme>;
  if constexpr (requires(const Scheme& scheme, const ProblemCard& problem) { scheme.conflicts(problem); })
    card.conflicts = [](std::span<const double> settings, const ProblemCard& problem) {
      return from_values<Scheme>(Scheme::fields, settings).conflicts(problem);
    };
  if constexpr (requires(const ProblemCard& problem) { Scheme::takes(problem); }) card.takes = &Scheme::takes;
  return card;
}
template <class... Scheme, class... More>
std::vector<SchemeCard> complete_cards(std::tuple<Scheme...>*, std::tuple<More...>*) {
  return {complete_card<Scheme>()..., complete_card<More>()...};
}

}  // namespace

std::span<const SchemeCard> scheme_cards() {
  static const std::vector<SchemeCard> cards =
      complete_cards(static_cast<SchemeList*>(nullptr), static_cast<TextSchemeList*>(nullptr));
  return cards;
}

std::span<const SchemeCard> schemes() { return scheme_cards(); }

std::shared_ptr<const Mechanics> find_problem(std::string_view id) {
  const auto all = problem_list();
  const auto found = std::ranges::find_if(all, [&](const auto& problem) { return problem->card().id == id; });
  return found == all.end() ? nullptr : *found;
}

std::optional<std::size_t> find_scheme(std::string_view id) {
  const auto found = std::ranges::find(schemes(), id, &SchemeCard::id);
  if (found == schemes().end()) return std::nullopt;
  return static_cast<std::size_t>(found - schemes().begin());
}

Request default_request(std::string_view problem, std::string_view scheme) {
  const auto mechanics = find_problem(problem);
  const auto index = find_scheme(scheme);
  if (!mechanics || !index) throw std::out_of_range(std::string(mechanics ? scheme : problem));
  const ProblemCard& card = mechanics->card();
  Scene scene{mechanics, {}, {}, 0};
  for (const auto& parameter : card.parameters) scene.parameters.push_back(parameter.value);
  for (const auto& variable : card.variables) scene.initial.push_back(variable.value);
  Request request;
  request.scene = std::make_shared<const Scene>(std::move(scene));
  request.scheme = *index;
  request.settings = plain_settings(&card, schemes()[*index], nullptr);
  request.end = card.span;
  for (std::size_t i = 0; i < card.columns.size(); ++i)
    if (card.columns[i].by_default) request.columns.push_back(i);
  for (std::size_t i = 0; i < card.diagnostics.size(); ++i)
    if (card.diagnostics[i].by_default) request.diagnostics.push_back(i);
  return request;
}

namespace {

/// offers returns in words which mechanics a problem offers to schemes.
std::string offers(const ProblemTraits& traits, const std::string& objection) {
  std::string words = (traits.conservative || (traits.forced && traits.potential)) && !traits.configuration_metric
                          ? "a separable Hamiltonian (a potential and a constant kinetic metric)"
                      : traits.linear_contact       ? "a contact Hamiltonian linear in s (a potential and a damping)"
                      : traits.quadratic_contact    ? "a contact Hamiltonian quadratic in s"
                      : traits.configuration_metric ? "a Lagrangian whose kinetic metric depends on the configuration"
                      : traits.general_lagrangian   ? "a regular Lagrangian L(q, v, s, t) of no simpler form"
                      : traits.general              ? "a Hamiltonian H(q, p, s, t) of no simpler form"
                      : traits.split_flow           ? "a vector field that is a sum of exact flows"
                                                    : "";
  if (traits.forced) words += " with forces beside it";
  if (!objection.empty()) words += " " + objection;
  words += words.empty() ? "equations of motion" : ", equations of motion";
  if (traits.autonomous) words += " that do not depend on time";
  return words;
}

}  // namespace

ProblemCard complete_card(ProblemCard card, const ProblemTraits& traits, std::vector<std::size_t> schemes) {
  card.keeps_energy = traits.keeps_energy;
  card.keeps_form = (traits.potential || traits.general) && !traits.forced;
  for (const auto& column : columns_of(traits, card)) card.columns.push_back(column.card);
  card.diagnostics = diagnostic_cards(traits);
  card.offers = offers(traits, card.lift_objection);
  card.schemes = std::move(schemes);
  std::erase_if(card.schemes, [&card](std::size_t i) {
    const SchemeCard& scheme = scheme_cards()[i];
    return scheme.takes && !scheme.takes(card);
  });
  return card;
}

std::vector<Column> all_columns(const ProblemTraits& traits, const ProblemCard& card) {
  return columns_of(traits, card);
}

}  // namespace least
