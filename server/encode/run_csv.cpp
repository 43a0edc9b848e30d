#include <cmath>

#include "server/encode/answer_parts.hpp"
#include "server/encode/sensitivities_out.hpp"

namespace least::server {
namespace {

constexpr std::size_t longest_field = 4096;  // as much as common clients and proxies accept in a field

// is_of_points tells whether the lines are points of a section, as there is no trajectory.
bool is_of_points(const FinishedRun& run) {
  const Record& record = run.request.record;
  return run.points && record.mode == Record::Mode::every && record.count == 0;
}
const KeptRows& rows_of(const FinishedRun& run) { return is_of_points(run) ? *run.points : run.samples; }
std::vector<std::size_t> columns_of(const FinishedRun& run) {
  return is_of_points(run) ? run.request.section_columns() : run.request.columns;
}

// Calls see(name, value) for every part of the answer besides the samples; the value is one line of ASCII.
template <class See>
void for_each_part(const FinishedRun& run, See see) {
  const Solution& outcome = run.outcome;
  const auto part = [&](const char* name, auto write) {
    std::string value;
    JsonWriter json(value, Notation::ascii);
    write(json);
    see(name, value);
  };
  if (outcome.stop.reason != ReturnCode::completed) {
    part("Leastaction-Stop", [&](JsonWriter& json) { write_stop(json, outcome.stop); });
  }
  if (!outcome.event.empty()) part("Leastaction-End", [&](JsonWriter& json) { write_end(json, outcome); });
  part("Leastaction-Request", [&](JsonWriter& json) {
    json.open('{');
    write_echo(json, run);
    json.close('}');
  });
  if (run.choice) part("Leastaction-Choice", [&](JsonWriter& json) { write_choice(json, *run.choice); });
  part("Leastaction-Final", [&](JsonWriter& json) { write_final(json, run, outcome); });
  part("Leastaction-Diagnostics", [&](JsonWriter& json) { write_reports(json, outcome.diagnostics); });
  if (run.points && !is_of_points(run)) {
    part("Leastaction-Section", [&](JsonWriter& json) { write_points(json, run); });
  }
  part("Leastaction-Events", [&](JsonWriter& json) { write_events(json, outcome.events); });
  if (!outcome.acts.empty()) part("Leastaction-Acts", [&](JsonWriter& json) { write_events(json, outcome.acts); });
  if (run.found)
    part("Leastaction-Sensitivities", [&](JsonWriter& json) { write_sensitivities(json, *run.found, false); });
  part("Leastaction-Cost", [&](JsonWriter& json) { write_cost(json, outcome.cost); });
  part("Leastaction-Warnings", [&](JsonWriter& json) { write_warnings(json, outcome.warnings); });
}

void write_row(std::string& text, const std::vector<const std::vector<std::string>*>& words,
               std::span<const double> row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) text += ',';
    if (!words[i]->empty()) {
      text += word_of(*words[i], row[i]);
    } else if (std::isfinite(row[i])) {
      append_number(text, row[i]);
    }
  }
}

// Writes `d(x)/d(mu)`, component by component and then by quantity, the order in a sample's list.
void write_names_of_slopes(std::string& text, const FoundSensitivities& of) {
  for (const std::string& row : of.found.rows)
    for (const std::string& by : of.asked.names)
      text.append(",d(").append(row).append(")/d(").append(by, by.rfind('/') + 1).append(")");
}

void write_slopes(std::string& text, const FoundSensitivities& of, std::size_t sample) {
  const std::size_t count = of.found.rows.size() * of.asked.names.size();
  const bool found = sample < of.found.samples.size();
  for (std::size_t i = 0; i < count; ++i) {
    text += ',';
    if (found && std::isfinite(of.found.samples[sample][i])) append_number(text, of.found.samples[sample][i]);
  }
}

// A piece for the line of names, then the slices of samples.
std::size_t pieces_of_table(const FinishedRun& run) { return 1 + rows_of(run).slices(); }

void write_csv(const FinishedRun& run, std::size_t piece, std::string& out) {
  const auto columns = columns_of(run);
  const KeptRows& kept = rows_of(run);
  const bool numbered = is_of_points(run);
  std::vector<const std::vector<std::string>*> words;
  for (const std::size_t column : columns) {
    const ColumnCard& card = run.request.column(column);
    words.push_back(&card.words);
    if (piece == 0) out.append(words.size() > 1 ? "," : numbered ? "crossing," : "").append(card.name);
  }
  const FoundSensitivities* const slopes = run.found && run.found->asked.at_samples ? &*run.found : nullptr;
  if (piece == 0) {
    if (slopes) write_names_of_slopes(out, *slopes);
    out += '\n';
    return;
  }
  const auto rows = kept.slice(piece - 1);
  std::size_t number = kept.rows_before(piece - 1);
  for (std::size_t at = 0; at < rows.size(); at += columns.size()) {
    if (numbered) out.append(std::to_string(number)).append(",");
    write_row(out, words, rows.subspan(at, columns.size()));
    if (slopes) write_slopes(out, *slopes, number);
    ++number;
    out += '\n';
  }
}

void add_csv_fields(const FinishedRun& run, Answer& answer) {
  answer.headers.emplace_back("Leastaction-Status", status_of(run.outcome));
  for_each_part(run, [&](const char* name, std::string& value) {
    answer.headers.emplace_back(name, value.size() <= longest_field ? std::move(value) : "{\"omitted\":true}");
  });
}

}  // namespace

const Form csv_form{"text/csv", "text/csv; charset=utf-8; header=present", pieces_of_table, write_csv, add_csv_fields};

}  // namespace least::server
