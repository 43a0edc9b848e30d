// The first half of decoding: the problem and its start, and schemes with their settings.
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
  names.reserve(cards.size() + 1);  // one more, for callers that add a name
  for (const auto& card : cards) names.push_back(card.id);
  return names;
}
inline Names names_of(std::span<const std::shared_ptr<const Mechanics>> problems) {
  Names names;
  names.reserve(problems.size() + 1);
  for (const auto& problem : problems) names.push_back(problem->card().id);
  return names;
}

/// NamedEntry is what `"kepler"` or `{"id": "kepler", …}` names, and the path of the name.
struct NamedEntry {
  std::optional<std::size_t> index;
  FieldPath path;
};
/// read_entry reads one; `what` says what is named ("problem"). `json` is null where the request has no value.
NamedEntry read_entry(const Json* json, const FieldPath& path, std::string_view what, const Names& ids);

/// read_problem returns the problem of a request, from the catalogue or given as text. After noting faults it returns
/// null, or a stand-in for the scene (see read_custom), of which only the names may be relied on.
std::shared_ptr<const Mechanics> read_problem(const Json& root, const FieldPath& top, const Cards& cards);

/// read_scene reads parameters and start of a scene whose mechanics is set: defaults of the card, then of the preset,
/// then the request. Returns the preset, or null. `velocities` receives those of all coordinates, where the start gives
/// them or they are 0.
const PresetCard* read_scene(const Json& root, const FieldPath& top, Scene& scene,
                             std::vector<double>* velocities = nullptr);

/// holds_velocities tells whether the velocities of the start, not the momenta, stay fixed while another number
/// changes: as `holds` of `asked` (at `path`) says, else as the start is given. `both`: `holds` may have either value.
bool holds_velocities(const Json& root, const Json& asked, const FieldPath& path, const text::TextScene* text,
                      bool both = true);

/// check_start notes the objections of a scene given as text to its start. A start where the mechanics is not finite,
/// but the motion is, is moved slightly, unless velocities of the request would be lost.
void check_start(const Json& root, const FieldPath& top, Scene& scene);

/// read_settings returns a scheme's settings: defaults of the card, then what the problem or its preset suggests, in
/// the units of the scene, then the scheme's preset, then the request. `scene`, if not null, must have been read;
/// `preset` may be null.
std::vector<double> read_settings(const Json& json, const FieldPath& path, const SchemeCard& card, const Scene* scene,
                                  const PresetCard* preset);

/// check_pair notes a fault where the scheme cannot run the problem, unless the problem is a stand-in; `path` is that
/// of the scheme's name.
void check_pair(const Cards& cards, const Scene& scene, std::size_t scheme, const FieldPath& path);

/// check_settings notes settings that are valid each but do not go together; `path` is the scheme's.
void check_settings(const SchemeCard& card, const ProblemCard& problem, const std::vector<double>& settings,
                    const FieldPath& path);

}  // namespace least::server
