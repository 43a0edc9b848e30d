#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"
#include "server/encode/columns_out.hpp"

namespace least::server {
namespace {

// The members after the trajectory; all forms but CSV end with them.
void write_findings(JsonWriter& json, const PlannedRun& run, const Solution& outcome) {
  write_final(json.key("final"), run, outcome);
  write_reports(json.key("diagnostics"), outcome.diagnostics);
  write_cost(json.key("cost"), outcome.cost);
  write_events(json.key("events"), outcome.events);
  write_warnings(json.key("warnings"), outcome.warnings);
}

void write_status(JsonWriter& json, const Solution& outcome) {
  json.key("status").text(status_of(outcome));
  if (outcome.stop.reason != ReturnCode::completed) write_stop(json.key("stop"), outcome.stop);
  if (!outcome.event.empty()) write_end(json.key("end"), outcome);
}

// Rows become columns: the samples lie row by row in memory.
void write_trajectory(JsonWriter& json, const FinishedRun& run, Outlet& out) {
  const auto& columns = run.request.columns;
  json.open('{');
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const ColumnCard& card = run.request.column(columns[column]);
    json.key(card.name);
    const bool packed = json.notation() == Notation::cbor && card.words.empty();
    packed ? begin_typed_array(json.buffer(), run.samples.rows()) : (void)json.open('[');
    bool first = true;
    for (const auto& block : run.samples.blocks()) {
      const Strided values{block, column, columns.size()};
      if (packed) {
        append_binary(out, values);
      } else if (card.words.empty()) {
        append_numbers(out, values, first);
      } else {
        write_words(json, card.words, values);
      }
      first = false;
      if (!out.pass_on()) return;
    }
    if (!packed) json.close(']');
  }
  json.close('}');
}

void write_whole(const FinishedRun& run, Outlet& out, Notation notation) {
  JsonWriter json(out.text(), notation);
  json.open('{').key("version").text(version);
  write_status(json, run.outcome);
  write_echo(json, run, "events_asked");
  if (run.choice) write_choice(json.key("choice"), *run.choice);
  write_trajectory(json.key("trajectory"), run, out);
  write_findings(json, run, run.outcome);
  json.close('}');
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

void write_json(const FinishedRun& run, Outlet& out) {
  write_whole(run, out, Notation::json);
  out.text() += '\n';
}
void write_cbor(const FinishedRun& run, Outlet& out) { write_whole(run, out, Notation::cbor); }

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
    Outlet whole;
    json.key("trajectory").open('{');
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const ColumnCard& card = run.request.column(columns[column]);
      const Strided values{rows, column, columns.size()};
      json.key(card.name).open('[');
      if (card.words.empty()) {
        append_numbers(whole, values, true);
        json.buffer() += whole.text();
        whole.text().clear();
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

std::string run_end_line(const PlannedRun& run, const Solution& outcome) {
  return run_line("end", [&](JsonWriter& json) {
    write_status(json, outcome);
    write_findings(json, run, outcome);
  });
}

std::span<const Form> forms() {
  static constexpr Form all[] = {{"application/json", "application/json", write_json},
                                 {"text/csv", "text/csv; charset=utf-8; header=present", write_csv, add_csv_fields},
                                 {"application/cbor", "application/cbor", write_cbor}};
  return all;
}

Answer whole_answer(const Form& form, const FinishedRun& run) {
  Answer answer;
  answer.type = form.content_type;
  if (form.add_fields) form.add_fields(run, answer);
  Outlet out;
  out.text().reserve(4096 + run.samples.rows() * run.samples.columns() * 20);
  form.write(run, out);
  answer.body = std::move(out.text());
  return answer;
}

}  // namespace least::server
