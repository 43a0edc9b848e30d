#include "core/catalogue.hpp"

#include <algorithm>

#include "core/entry.hpp"

namespace least {

std::span<const ProblemCard> problem_cards() {
  static const std::vector<ProblemCard> cards = [] {
    std::vector<ProblemCard> all;
    for (const ProblemEntry* entry : problem_entries()) all.push_back(entry->card);
    return all;
  }();
  return cards;
}

namespace {
/// What a scheme's card takes from its description.
template <class Scheme>
void complete(SchemeCard& card) {
  card.parameters = parameter_cards(Scheme::fields);
  card.own_clock = OwnClock<Scheme>;
  if constexpr (requires(const Scheme& scheme, const ProblemCard& problem) { scheme.conflicts(problem); })
    card.conflicts = [](std::span<const double> settings, const ProblemCard& problem) {
      return assemble<Scheme>(Scheme::fields, settings).conflicts(problem);
    };
}
}  // namespace

std::span<const SchemeCard> schemes() {
  static const std::vector<SchemeCard> cards = [] {
    std::vector<SchemeCard> all;
    [&]<class... Scheme>(std::tuple<Scheme...>*) {
      ((all.push_back(Scheme::card()), complete<Scheme>(all.back())), ...);
    }(static_cast<SchemeList*>(nullptr));
    return all;
  }();
  return cards;
}

namespace {
template <class Cards>
std::optional<std::size_t> find(const Cards& cards, std::string_view id) {
  const auto found = std::ranges::find_if(cards, [&](const auto& card) { return card.id == id; });
  if (found == cards.end()) return std::nullopt;
  return static_cast<std::size_t>(found - cards.begin());
}
}  // namespace

std::optional<std::size_t> find_problem(std::string_view id) { return find(problem_cards(), id); }
std::optional<std::size_t> find_scheme(std::string_view id) { return find(schemes(), id); }

std::vector<std::string_view> column_words(const ProblemCard& problem, std::size_t column) {
  const std::string_view name = problem.columns[column];
  if (name == "mode") return {mode_names.begin(), mode_names.end()};
  std::vector<std::string_view> words;
  if (name == "parameter")
    for (const auto& variable : problem.variables) words.push_back(variable.name);
  return words;
}

bool fits(std::size_t problem, std::size_t scheme) { return problem_entries()[problem]->runs[scheme] != nullptr; }

Outcome run(const Request& request, Sink& sink, const std::atomic<bool>& cancelled) {
  const ProblemEntry& entry = *problem_entries()[request.problem];
  return entry.runs[request.scheme](entry.card, schemes()[request.scheme], request, sink, cancelled);
}

Truth compute_truth(const Request& scene, const std::vector<double>& times, const std::function<bool()>& keep_going) {
  return problem_entries()[scene.problem]->truth(scene, times, keep_going);
}

Conditioning compute_conditioning(const Request& scene, const std::function<bool()>& keep_going) {
  return problem_entries()[scene.problem]->conditioning(scene, keep_going);
}

}  // namespace least
