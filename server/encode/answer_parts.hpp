// Pieces of the answer that more than one form writes. Each writes one value.
#pragma once

#include "core/text/written_out.hpp"
#include "server/encode/run_answer.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// The members of a complete request that gives this run again: problem, initial, scheme, until, record, columns,
/// section, events, limits, norm; the last but two where there are any. `beside_findings`: what was found stands beside
/// it, so that events are called events_asked, and the section is left to who writes its points.
void write_echo(JsonWriter& json, const PlannedRun& run, bool beside_findings = false);
/// The members problem and initial.
void write_scene(JsonWriter& json, const Scene& scene);
/// The members of a scene as text, but its id, as it was given.
void write_definition(JsonWriter& json, const text::Definition& written);
/// The members views and bodies of a scene as text, those that it states.
void write_pictures(JsonWriter& json, const text::Pictures& pictures);
/// A scheme as a request spells it.
void write_scheme(JsonWriter& json, const SchemeCard& card, const std::vector<double>& settings);
void write_until(JsonWriter& json, const Request& request);
void write_record(JsonWriter& json, const Request& request);
/// The members of the section asked for, without its brackets.
void write_section_asked(JsonWriter& json, const Request& request);
/// A column as a request names it: by its name, or as the expression that it is.
void write_asked_column(JsonWriter& json, const Request& request, std::size_t place);
/// The member norm.
void write_norm(JsonWriter& json, const Request& request);
/// Why a scheme was chosen, and what else there was.
void write_choice(JsonWriter& json, const AdviceWithCards& choice);
void write_stop(JsonWriter& json, const Termination& stop);
/// The event that ended the run.
void write_end(JsonWriter& json, const Solution& outcome);
void write_final(JsonWriter& json, const PlannedRun& run, const Solution& outcome);
/// Entries with names are an object, entries without are a list.
void write_reports(JsonWriter& json, const std::vector<Report>& reports);
void write_events(JsonWriter& json, const std::vector<Report>& events);
void write_cost(JsonWriter& json, const Cost& cost);
void write_warnings(JsonWriter& json, const std::vector<Warning>& warnings);

/// The word that a code stands for; empty where it stands for none.
std::string_view word_of(const std::vector<std::string>& words, double code);

inline std::string_view status_of(const Solution& outcome) {
  return outcome.stop.reason == ReturnCode::completed ? "completed" : "stopped";
}

/// An object on a line of NDJSON: its kind, then what `write_members` writes.
template <class WriteMembers>
std::string object_line(std::string_view kind, WriteMembers write_members) {
  std::string text;
  JsonWriter json(text);
  json.open('{').key("kind").text(kind);
  write_members(json);
  json.close('}');
  return text += '\n';
}

}  // namespace least::server
