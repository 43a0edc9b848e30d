#include <cmath>

#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

constexpr std::size_t longest_field = 4096;  // what common clients and proxies take in one field

// Calls see(name, value) for every part of the answer that is no sample, the value one line of plain ASCII.
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
  part("Leastaction-Events", [&](JsonWriter& json) { write_events(json, outcome.events); });
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
  text += '\n';
}

}  // namespace

void add_csv_fields(const FinishedRun& run, Answer& answer) {
  answer.headers.emplace_back("Leastaction-Status", status_of(run.outcome));
  for_each_part(run, [&](const char* name, std::string& value) {
    answer.headers.emplace_back(name, value.size() <= longest_field ? std::move(value) : "{\"omitted\":true}");
  });
}

void write_csv(const FinishedRun& run, Outlet& out) {
  const auto& columns = run.request.columns;
  std::vector<const std::vector<std::string>*> words;
  for (const std::size_t column : columns) {
    const ColumnCard& card = run.request.column(column);
    if (!words.empty()) out.text() += ',';
    out.text() += card.name;
    words.push_back(&card.words);
  }
  out.text() += '\n';
  for (const auto& block : run.samples.blocks()) {
    for (std::size_t at = 0; at < block.size() && out.pass_on(); at += columns.size()) {
      write_row(out.text(), words, std::span(block).subspan(at, columns.size()));
    }
  }
  for_each_part(run, [&](const char* name, const std::string& value) {
    if (value.size() <= longest_field) return;
    out.text().append("# ").append(name).append(": ").append(value).append("\n");
    out.pass_on();
  });
}

}  // namespace least::server
