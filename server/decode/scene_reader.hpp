// The first half of decoding: which problem from which start, and schemes with their settings.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

template <class Card>
Names names_of(std::span<const Card> cards) {
  Names names;
  for (const auto& card : cards) names.push_back(card.id);
  return names;
}

/// `"kepler"` or `{"id": "kepler", …}`: what it names, and where the name stands.
struct Chosen {
  std::optional<std::size_t> index;
  Place place;
};
/// `what` says what they are ("problem"); null where there is no value at all.
Chosen choose(const Json* json, const Place& place, std::string_view what, const Names& ids);

/// The problem's parameters and the start: card, then preset, then what the request says. The preset, if there is one.
const PresetCard* read_scene(const Json& root, const Place& top, const ProblemCard& card, Request& request);

/// A scheme's settings: card, then what the problem (or its preset `scene`) suggests, then the scheme's preset, then
/// what the request says. `problem` and `scene` may be null.
std::vector<double> read_settings(const Json& json, const Place& place, const SchemeCard& card,
                                  const ProblemCard* problem, const PresetCard* scene);

/// Whether the scheme can run the problem; `place` is that of the scheme's name.
void check_pair(const Cards& cards, const ProblemCard& problem, std::size_t scheme, const Place& place);

/// Settings that were read without a fault, for a pair that fits, and do not go together; `place` is the scheme's.
void check_settings(const SchemeCard& card, const ProblemCard& problem, const std::vector<double>& settings,
                    const Place& place);

}  // namespace least::server
