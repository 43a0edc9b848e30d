// The first half of decoding: which problem from which start, and schemes with their settings.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

inline Names names_of(std::span<const SchemeCard> cards) {
  Names names;
  names.reserve(cards.size() + 1);  // and one that is not among them
  for (const auto& card : cards) names.push_back(card.id);
  return names;
}
inline Names names_of(std::span<const std::shared_ptr<const Mechanics>> problems) {
  Names names;
  names.reserve(problems.size() + 1);
  for (const auto& problem : problems) names.push_back(problem->card().id);
  return names;
}

/// What `"kepler"` or `{"id": "kepler", …}` names, and where the name stands.
struct NamedEntry {
  std::optional<std::size_t> index;
  FieldPath path;
};
/// `what` says what they are ("problem"); null where there is no value at all.
NamedEntry read_entry(const Json* json, const FieldPath& path, std::string_view what, const Names& ids);

/// The problem of a request: of the catalogue, or a scene as text. Null after noting what is wrong.
std::shared_ptr<const Mechanics> read_problem(const Json& root, const FieldPath& top, const Cards& cards);

/// The parameters and the start of a scene whose mechanics is known: card, then preset, then what the request says. The
/// preset, if there is one. `velocities`: those of all coordinates, where the start says them or they are 0.
const PresetCard* read_scene(const Json& root, const FieldPath& top, Scene& scene,
                             std::vector<double>* velocities = nullptr);

/// Whether the velocities of the start stay where another number of the scene changes, and not the momenta: as `holds`
/// of `asked`, which stands at the path, says, or else the start. `both`: it may say either.
bool holds_velocities(const Json& root, const Json& asked, const FieldPath& path, const text::TextScene* text,
                      bool both = true);

/// What a scene as text that was read without a fault has against its start. A start at a place where the mechanics is
/// not finite, but the motion is, moves beside it.
void check_start(const Json& root, const FieldPath& top, Scene& scene);

/// A scheme's settings: card, then what the problem (or the preset of its card) suggests, in the units of the scene,
/// then the scheme's preset, then what the request says. `scene`, which has been read, and `preset` may be null.
std::vector<double> read_settings(const Json& json, const FieldPath& path, const SchemeCard& card, const Scene* scene,
                                  const PresetCard* preset);

/// Whether the scheme can run the problem; `path` is that of the scheme's name.
void check_pair(const Cards& cards, const Scene& scene, std::size_t scheme, const FieldPath& path);

/// Settings that were read without a fault, for a pair that fits, and do not go together; `path` is the scheme's.
void check_settings(const SchemeCard& card, const ProblemCard& problem, const std::vector<double>& settings,
                    const FieldPath& path);

}  // namespace least::server
