#include <algorithm>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"
#include "server/encode/columns_out.hpp"
#include "server/encode/sensitivities_out.hpp"

namespace least::server {
namespace {

// Writes the members between trajectory and sensitivities; in all formats but CSV the answer ends with them, the
// sensitivities and the warnings.
void write_findings(JsonWriter& json, const PlannedRun& run, const Solution& outcome) {
  write_final(json.key("final"), run, outcome);
  write_reports(json.key("diagnostics"), outcome.diagnostics);
  write_cost(json.key("cost"), outcome.cost);
  write_events(json.key("events"), outcome.events);
  if (!outcome.acts.empty()) write_events(json.key("acts"), outcome.acts);
}

void write_status(JsonWriter& json, const Solution& outcome) {
  json.key("status").text(status_of(outcome));
  if (outcome.stop.reason != ReturnCode::completed) write_stop(json.key("stop"), outcome.stop);
  if (!outcome.event.empty()) write_end(json.key("end"), outcome);
}

// Table is row-major rows that are written column by column. Where there are no rows, one piece opens and closes each
// column.
struct Table {
  const KeptRows& rows;
  const std::vector<const ColumnCard*>& cards;

  std::size_t slices() const { return std::max<std::size_t>(rows.slices(), 1); }
  std::size_t pieces() const { return cards.size() * slices(); }
};

Table samples_of(const FinishedRun& run) { return {run.samples, run.columns}; }
Table points_of(const FinishedRun& run) { return {*run.points, run.point_columns}; }

// `first`: the first column is the first member of the open object.
void write_column(const Table& table, std::size_t piece, bool first, std::string& out, Notation notation) {
  const std::size_t column = piece / table.slices(), slice = piece % table.slices();
  const ColumnCard& card = *table.cards[column];
  const bool packed = notation == Notation::cbor && card.words.empty(), begins = slice == 0;
  JsonWriter json(out, notation, begins && column == 0 && first);
  if (begins) {
    json.key(card.name);
    packed ? begin_typed_array(out, table.rows.rows()) : (void)json.open('[');
  }
  if (slice < table.rows.slices()) {
    const Strided values{table.rows.slice(slice), column, table.cards.size()};
    if (packed) {
      append_binary(out, values);
    } else if (card.words.empty()) {
      append_numbers(out, values, begins);
    } else {
      write_words(json, card.words, values);
    }
  }
  if (slice + 1 == table.slices() && !packed) json.close(']');
}

// Writes the numbers of the points in a slice, counted from 0.
void write_crossings(const KeptRows& points, std::size_t slice, JsonWriter& json) {
  const auto from = static_cast<std::int64_t>(points.rows_before(slice));
  const auto count = slice < points.slices() ? std::ssize(points.slice(slice)) / std::int64_t(points.columns()) : 0;
  for (std::int64_t i = 0; i < count; ++i) json.integer(from + i);
}

// A section is a piece that opens it, then its crossings and its columns; the piece after them closes it.
std::size_t pieces_of_section(const FinishedRun& run) {
  if (run.points == nullptr) return 0;
  const Table points = points_of(run);
  return 1 + points.slices() + points.pieces();
}
void write_section(const FinishedRun& run, std::size_t piece, std::string& out, Notation notation) {
  const Table points = points_of(run);
  if (piece > points.slices()) return write_column(points, piece - 1 - points.slices(), false, out, notation);
  JsonWriter json(out, notation, piece == 1);
  if (piece == 0) {
    json.close('}').key("section").open('{');
    write_section_asked(json, run.request);
    json.key("crossing").open('[');
    return;
  }
  write_crossings(*run.points, piece - 1, json);
  if (piece == points.slices()) json.close(']');
}

// Sensitivities at samples: a piece that opens their list, some samples in each piece, and a piece that closes it.
std::size_t samples_in_a_piece(const FinishedRun& run) {
  constexpr std::size_t numbers = 8192;
  const auto& samples = run.found->found.samples;
  return std::max<std::size_t>(numbers / std::max<std::size_t>(samples.empty() ? 1 : samples.front().size(), 1), 1);
}
std::size_t pieces_of_slopes(const FinishedRun& run) {
  if (!run.found || !run.found->asked.at_samples) return 0;
  const std::size_t count = samples_in_a_piece(run);
  return 1 + (run.found->found.samples.size() + count - 1) / count;
}

// The trajectory, with a piece before it and a piece after it.
std::size_t pieces_of(const FinishedRun& run) {
  return 2 + samples_of(run).pieces() + pieces_of_section(run) + pieces_of_slopes(run);
}

// Writes one of the pieces after trajectory and section.
void write_after(const FinishedRun& run, std::size_t piece, std::string& out, Notation notation) {
  const std::size_t last = pieces_of_slopes(run), count = last > 0 ? samples_in_a_piece(run) : 0;
  JsonWriter json(out, notation, piece == 1 && last > 1);
  if (piece == 0) {
    json.close('}');
    write_findings(json, run, run.outcome);
    if (last > 0) return begin_sensitivities(json.key("sensitivities"), *run.found);
  }
  if (piece < last) {
    const std::size_t from = (piece - 1) * count;
    return write_samples(json, *run.found, from, std::min(from + count, run.found->found.samples.size()));
  }
  if (last > 0) end_sensitivities(json, *run.found);
  if (last == 0 && run.found) write_sensitivities(json.key("sensitivities"), *run.found);
  write_warnings(json.key("warnings"), run.outcome.warnings);
  json.close('}');
  if (notation == Notation::json) out += '\n';
}

void write_piece(const FinishedRun& run, std::size_t piece, std::string& out, Notation notation) {
  const Table samples = samples_of(run);
  const std::size_t section = 1 + samples.pieces(), after = section + pieces_of_section(run);
  if (piece > 0 && piece < section) return write_column(samples, piece - 1, true, out, notation);
  if (piece >= section && piece < after) return write_section(run, piece - section, out, notation);
  if (piece > 0) return write_after(run, piece - after, out, notation);
  JsonWriter json(out, notation);
  json.open('{').key("version").text(version);
  write_status(json, run.outcome);
  write_echo(json, run, true);
  if (run.choice) write_choice(json.key("choice"), *run.choice);
  json.key("trajectory").open('{');
}

void write_json(const FinishedRun& run, std::size_t piece, std::string& out) {
  write_piece(run, piece, out, Notation::json);
}
void write_cbor(const FinishedRun& run, std::size_t piece, std::string& out) {
  write_piece(run, piece, out, Notation::cbor);
}

}  // namespace

std::vector<const ColumnCard*> cards_of(const Request& request, const std::vector<std::size_t>& columns) {
  std::vector<const ColumnCard*> cards;
  cards.reserve(columns.size());
  for (const std::size_t place : columns) cards.push_back(&request.column(place));
  return cards;
}

std::string run_head_line(const PlannedRun& run) {
  return object_line("head", [&](JsonWriter& json) {
    json.key("version").text(version);
    write_echo(json, run);
    if (run.choice) write_choice(json.key("choice"), *run.choice);
  });
}

namespace {

// Writes columns of row-major rows, as members of the open object.
void write_rows(JsonWriter& json, const std::vector<const ColumnCard*>& cards, std::span<const double> rows) {
  for (std::size_t column = 0; column < cards.size(); ++column) {
    const ColumnCard& card = *cards[column];
    const Strided values{rows, column, cards.size()};
    json.key(card.name).open('[');
    if (card.words.empty()) {
      append_numbers(json.buffer(), values, true);
    } else {
      write_words(json, card.words, values);
    }
    json.close(']');
  }
}

}  // namespace

std::string run_samples_line(const PlannedRun& run, std::span<const double> rows) {
  return object_line("samples", [&](JsonWriter& json) {
    json.key("trajectory").open('{');
    write_rows(json, cards_of(run.request, run.request.columns), rows);
    json.close('}');
  });
}

std::string run_points_line(const PlannedRun& run, std::span<const double> rows, std::int64_t before) {
  return object_line("section", [&](JsonWriter& json) {
    const auto cards = cards_of(run.request, run.request.section_columns());
    json.key("section").open('{').key("crossing").open('[');
    for (std::size_t i = 0; i < rows.size() / cards.size(); ++i) json.integer(before + std::int64_t(i));
    json.close(']');
    write_rows(json, cards, rows);
    json.close('}');
  });
}

std::string run_progress_line(double t, std::int64_t steps) {
  return object_line("progress", [&](JsonWriter& json) { json.key("t").number(t).key("steps").integer(steps); });
}

std::string run_end_line(const PlannedRun& run, const Solution& outcome, const variations::Sensitivities* slopes) {
  return object_line("end", [&](JsonWriter& json) {
    write_status(json, outcome);
    write_findings(json, run, outcome);
    if (run.sensitivities && slopes) write_sensitivities(json.key("sensitivities"), {*run.sensitivities, *slopes});
    write_warnings(json.key("warnings"), outcome.warnings);
  });
}

void write_points(JsonWriter& json, const FinishedRun& run) {
  json.open('{');
  write_section_asked(json, run.request);
  json.key("crossing").open('[');
  for (std::size_t slice = 0; slice < run.points->slices(); ++slice) write_crossings(*run.points, slice, json);
  json.close(']');
  const Table points = points_of(run);
  for (std::size_t piece = 0; piece < points.pieces(); ++piece)
    write_column(points, piece, false, json.buffer(), json.notation());
  json.close('}');
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
  const std::size_t points = run.points ? run.points->rows() * run.points->columns() : 0;
  answer.body.reserve(4096 + (run.samples.rows() * run.samples.columns() + points) * 20);
  for (std::size_t piece = 0; piece < form.pieces(run); ++piece) form.write(run, piece, answer.body);
  return answer;
}

}  // namespace least::server
