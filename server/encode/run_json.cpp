#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

// Every `stride`-th value from `first` on, as numbers.
void write_numbers(std::string& out, const std::vector<double>& values, std::size_t first, std::size_t stride) {
  char block[8192];  // stays in the cache
  char* at = block;
  for (std::size_t i = first; i < values.size(); i += stride) {
    if (at > block + sizeof block - longest_number - 1) {
      out.append(block, at);
      at = block;
    }
    if (i != first) *at++ = ',';
    at = write_number(at, values[i]);
  }
  out.append(block, at);
}

// Rows become columns: the samples lie row by row in memory.
void write_trajectory(JsonWriter& json, const FinishedRun& run) {
  const auto& columns = run.request.columns;
  const auto& values = run.samples.values;
  json.open('{');
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const ColumnCard& card = run.problem.columns[columns[column]];
    json.key(card.name).open('[');
    const auto& words = card.words;
    if (words.empty()) write_numbers(json.buffer(), values, column, columns.size());
    for (std::size_t i = column; !words.empty() && i < values.size(); i += columns.size()) {
      const auto word = word_of(words, values[i]);
      word.empty() ? json.null() : json.text(word);
    }
    json.close(']');
  }
  json.close('}');
}

}  // namespace

Answer encode_json(const FinishedRun& run) {
  Answer answer;
  answer.type = "application/json";
  answer.body.reserve(4096 + run.samples.values.size() * 20);
  JsonWriter json(answer.body);
  json.open('{').key("version").text(version).key("status").text(status_of(run.outcome));
  if (run.outcome.stop.reason != ReturnCode::completed) write_stop(json.key("stop"), run.outcome.stop);
  write_echo(json, run);
  if (run.choice) write_choice(json.key("choice"), *run.choice);
  write_trajectory(json.key("trajectory"), run);
  write_final(json.key("final"), run);
  write_reports(json.key("diagnostics"), run.outcome.diagnostics);
  write_cost(json.key("cost"), run.outcome.cost);
  write_events(json.key("events"), run.outcome.events);
  write_warnings(json.key("warnings"), run.outcome.warnings);
  json.close('}');
  answer.body += '\n';
  return answer;
}

}  // namespace least::server
