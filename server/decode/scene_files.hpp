// Problems of the catalogue that are given as text: one file of core/scenes each, embedded in the binary.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/run/mechanics.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// SceneFile is one file: its name (`/pleiades.json`), its media type and its bytes, all with static lifetime.
struct SceneFile {
  std::string_view path, type, body;
};
/// scene_files() returns all files of core/scenes; the build generates the definition.
std::span<const SceneFile> scene_files();

/// TextProblem is a problem of the catalogue read from a file, whose name is the problem's id. The file contains
///   title, summary, references: as in every card,
///   scene: the scene as a request gives it, without its id,
///   about: {name: {doc, unit, symbol}} of variables, momenta and parameters, one entry for all elements of a list,
///   initial, until: the default start and end time,
///   suggested: {step, …}, defaults of settings of schemes,
///   presets: [{name, doc, parameters, initial, until, suggested}], whose start overrides the default one,
///   events: what a run watches where the request has no `events`.
struct TextProblem {
  std::shared_ptr<const Mechanics> mechanics;
  Json events;  ///< null where there are none
  /// Velocities of the default start, at "", and of those of presets, where the file states no momenta: they stay where
  /// a request changes a parameter or a coordinate.
  std::map<std::string, std::vector<double>, std::less<>> velocities;
};
/// read_scene_file reads one. Throws std::logic_error with what is wrong with the file, std::runtime_error where this
/// build omits its form.
TextProblem read_scene_file(std::string_view path, std::string_view body);

/// text_problems() returns all problems whose form this build has; they are read once.
const std::vector<TextProblem>& text_problems();

/// default_velocities returns the velocities of the default start of a scene, or of a preset, in the order of the
/// coordinates; empty for a scene that is not of a file, or whose start is stated in momenta.
const std::vector<double>& default_velocities(const text::TextScene& scene, std::string_view preset = {});

/// own_events returns the events that a scene brings along; null where it has none.
const Json* own_events(const Mechanics& problem);
/// refuse_own_events notes a fault where a scene has events but the request cannot have them.
void refuse_own_events(const Mechanics& problem, const FieldPath& path);

}  // namespace least::server
