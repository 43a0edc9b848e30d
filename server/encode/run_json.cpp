#include <algorithm>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"
#include "server/encode/columns_out.hpp"
#include "server/encode/sensitivities_out.hpp"

namespace least::server {
namespace {

// The members after the trajectory; all forms but CSV end with them.
void write_findings(JsonWriter& json, const PlannedRun& run, const Solution& outcome,
                    const std::optional<FoundSensitivities>& found) {
  write_final(json.key("final"), run, outcome);
  write_reports(json.key("diagnostics"), outcome.diagnostics);
  write_cost(json.key("cost"), outcome.cost);
  write_events(json.key("events"), outcome.events);
  if (!outcome.acts.empty()) write_events(json.key("acts"), outcome.acts);
  if (found) write_sensitivities(json.key("sensitivities"), *found);
  write_warnings(json.key("warnings"), outcome.warnings);
}

void write_status(JsonWriter& json, const Solution& outcome) {
  json.key("status").text(status_of(outcome));
  if (outcome.stop.reason != ReturnCode::completed) write_stop(json.key("stop"), outcome.stop);
  if (!outcome.event.empty()) write_end(json.key("end"), outcome);
}

// The trajectory stands between a piece with all before it and one with all after it, column by column: the samples
// lie row by row in memory. Where there are none, a piece opens and closes each column.
std::size_t slices_of(const FinishedRun& run) { return std::max<std::size_t>(run.samples.slices(), 1); }
std::size_t pieces_of(const FinishedRun& run) { return 2 + run.request.columns.size() * slices_of(run); }

void write_column(const FinishedRun& run, std::size_t column, std::size_t slice, std::string& out, Notation notation) {
  const auto& columns = run.request.columns;
  const ColumnCard& card = run.request.column(columns[column]);
  const bool packed = notation == Notation::cbor && card.words.empty(), begins = slice == 0;
  JsonWriter json(out, notation, begins && column == 0);
  if (begins) {
    json.key(card.name);
    packed ? begin_typed_array(out, run.samples.rows()) : (void)json.open('[');
  }
  if (slice < run.samples.slices()) {
    const Strided values{run.samples.slice(slice), column, columns.size()};
    if (packed) {
      append_binary(out, values);
    } else if (card.words.empty()) {
      append_numbers(out, values, begins);
    } else {
      write_words(json, card.words, values);
    }
  }
  if (slice + 1 == slices_of(run) && !packed) json.close(']');
}

void write_piece(const FinishedRun& run, std::size_t piece, std::string& out, Notation notation) {
  const std::size_t last = pieces_of(run) - 1;
  if (piece > 0 && piece < last) {
    return write_column(run, (piece - 1) / slices_of(run), (piece - 1) % slices_of(run), out, notation);
  }
  JsonWriter json(out, notation);
  if (piece == 0) {
    json.open('{').key("version").text(version);
    write_status(json, run.outcome);
    write_echo(json, run, "events_asked");
    if (run.choice) write_choice(json.key("choice"), *run.choice);
    json.key("trajectory").open('{');
  } else {
    json.close('}');
    write_findings(json, run, run.outcome, run.found);
    json.close('}');
    if (notation == Notation::json) out += '\n';
  }
}

void write_json(const FinishedRun& run, std::size_t piece, std::string& out) {
  write_piece(run, piece, out, Notation::json);
}
void write_cbor(const FinishedRun& run, std::size_t piece, std::string& out) {
  write_piece(run, piece, out, Notation::cbor);
}

// An object on a line.
template <class WriteMembers>
std::string run_line(std::string_view kind, WriteMembers write_members) {
  std::string text;
  JsonWriter json(text);
  json.open('{').key("kind").text(kind);
  write_members(json);
  json.close('}');
  return text += '\n';
}

}  // namespace

std::string run_head_line(const PlannedRun& run) {
  return run_line("head", [&](JsonWriter& json) {
    json.key("version").text(version);
    write_echo(json, run);
    if (run.choice) write_choice(json.key("choice"), *run.choice);
  });
}

std::string run_samples_line(const PlannedRun& run, std::span<const double> rows) {
  return run_line("samples", [&](JsonWriter& json) {
    const auto& columns = run.request.columns;
    json.key("trajectory").open('{');
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const ColumnCard& card = run.request.column(columns[column]);
      const Strided values{rows, column, columns.size()};
      json.key(card.name).open('[');
      if (card.words.empty()) {
        append_numbers(json.buffer(), values, true);
      } else {
        write_words(json, card.words, values);
      }
      json.close(']');
    }
    json.close('}');
  });
}

std::string run_progress_line(double t, std::int64_t steps) {
  return run_line("progress", [&](JsonWriter& json) { json.key("t").number(t).key("steps").integer(steps); });
}

std::string run_end_line(const PlannedRun& run, const Solution& outcome, const variations::Sensitivities* slopes) {
  std::optional<FoundSensitivities> found;
  if (run.sensitivities && slopes) found.emplace(FoundSensitivities{*run.sensitivities, *slopes});
  return run_line("end", [&](JsonWriter& json) {
    write_status(json, outcome);
    write_findings(json, run, outcome, found);
  });
}

std::span<const Form> forms() {
  static const Form all[] = {{"application/json", "application/json", pieces_of, write_json},
                             csv_form,
                             {"application/cbor", "application/cbor", pieces_of, write_cbor}};
  return all;
}

Answer whole_answer(const Form& form, const FinishedRun& run) {
  Answer answer;
  answer.type = form.content_type;
  if (form.add_fields) form.add_fields(run, answer);
  answer.body.reserve(4096 + run.samples.rows() * run.samples.columns() * 20);
  for (std::size_t piece = 0; piece < form.pieces(run); ++piece) form.write(run, piece, answer.body);
  return answer;
}

}  // namespace least::server
