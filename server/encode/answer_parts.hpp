// Parts of answers that more than one format writes. Each function writes one value, or members of the open object.
#pragma once

#include "core/text/written_out.hpp"
#include "server/encode/run_answer.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// write_echo writes the members of a complete request that reproduces this run: problem, initial, scheme, until,
/// record, columns, section, events, limits, norm, sensitivities; section, events and sensitivities only where there
/// are any (events of a catalogue problem given as text always). `beside_findings`: the results are in the same object,
/// so that events are called events_asked, while section and sensitivities are written with what was found.
void write_echo(JsonWriter& json, const PlannedRun& run, bool beside_findings = false);
/// write_scene writes the members problem and initial.
void write_scene(JsonWriter& json, const Scene& scene);
/// write_definition writes the members of a scene given as text, except its id.
void write_definition(JsonWriter& json, const text::Definition& written);
/// write_pictures writes the members views and bodies of a scene given as text, where it has them.
void write_pictures(JsonWriter& json, const text::Pictures& pictures);
/// write_scheme writes a scheme as a request spells it.
void write_scheme(JsonWriter& json, const SchemeCard& card, const std::vector<double>& settings);
void write_until(JsonWriter& json, const Request& request);
void write_record(JsonWriter& json, const Request& request);
/// write_section_asked writes the members of the requested section, without brackets.
void write_section_asked(JsonWriter& json, const Request& request);
/// write_asked_column writes a column as a request gives it: by name, or as an expression.
void write_asked_column(JsonWriter& json, const Request& request, std::size_t place);
/// write_norm writes the member norm.
void write_norm(JsonWriter& json, const Request& request);
/// write_choice writes why a scheme was chosen, and the alternatives.
void write_choice(JsonWriter& json, const AdviceWithCards& choice);
void write_stop(JsonWriter& json, const Termination& stop);
/// write_end writes the event that ended the run.
void write_end(JsonWriter& json, const Solution& outcome);
void write_final(JsonWriter& json, const PlannedRun& run, const Solution& outcome);
/// write_reports writes entries with names as an object, entries without as a list.
void write_reports(JsonWriter& json, const std::vector<Report>& reports);
void write_events(JsonWriter& json, const std::vector<Report>& events);
void write_cost(JsonWriter& json, const Cost& cost);
void write_warnings(JsonWriter& json, const std::vector<Warning>& warnings);

/// word_of returns the word that a code stands for; empty where there is none.
std::string_view word_of(const std::vector<std::string>& words, double code);

inline std::string_view status_of(const Solution& outcome) {
  return outcome.stop.reason == ReturnCode::completed ? "completed" : "stopped";
}

/// object_line returns an object as a line of NDJSON: its kind, then what write_members writes.
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
