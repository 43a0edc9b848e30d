// The problems of the catalogue that are scenes as text: a file of core/scenes each, embedded in the binary.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/mechanics.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// One file: its name (`/pleiades.json`), its media type and its bytes. All of static storage.
struct SceneFile {
  std::string_view path, type, body;
};
/// All files of core/scenes; the build makes the definition from them.
std::span<const SceneFile> scene_files();

/// A problem of the catalogue that a file describes: its name is the problem's id. In the file stand
///   title, summary, references: as in every card,
///   scene: what a request says of a scene as text, without its id,
///   about: {name: {doc, unit, symbol}} of variables, momenta and parameters, one for all elements of a list,
///   initial, until: the default start and the time of its end,
///   suggested: {step, …}, the defaults of settings of schemes,
///   presets: [{name, doc, parameters, initial, until, suggested}], whose start stands over the default one,
///   events: what a run of the scene watches where a request says nothing of events.
struct TextProblem {
  std::shared_ptr<const Mechanics> mechanics;
  Json events;  ///< null: none
};
/// Reads one. Throws std::logic_error that says what is wrong with the file, std::runtime_error where this build leaves
/// its form out.
TextProblem read_scene_file(std::string_view path, std::string_view body);

/// All whose form this build has, read once.
const std::vector<TextProblem>& text_problems();

/// The events that a scene brings along; null: none.
const Json* own_events(const Mechanics& problem);
/// Notes a fault where it brings some along and a request cannot have them.
void refuse_own_events(const Mechanics& problem, const FieldPath& path);

}  // namespace least::server
