#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

// A header field's value as one line of plain ASCII.
template <class Write>
void add_field(Answer& answer, const char* name, Write write) {
  std::string value;
  JsonWriter json(value, true);
  write(json);
  constexpr std::size_t longest = 4096;  // what common clients and proxies take in one field
  answer.headers.emplace_back(name, value.size() <= longest ? value : "{\"omitted\":true}");
}

}  // namespace

Answer encode_csv(const FinishedRun& run) {
  Answer answer;
  answer.type = "text/csv; charset=utf-8; header=present";
  const Solution& outcome = run.outcome;
  answer.headers.emplace_back("Leastaction-Status", status_of(outcome));
  if (outcome.stop.reason != ReturnCode::completed) {
    add_field(answer, "Leastaction-Stop", [&](JsonWriter& json) { write_stop(json, outcome.stop); });
  }
  add_field(answer, "Leastaction-Request", [&](JsonWriter& json) {
    json.open('{');
    write_echo(json, run);
    json.close('}');
  });
  if (run.choice) {
    add_field(answer, "Leastaction-Choice", [&](JsonWriter& json) { write_choice(json, *run.choice); });
  }
  add_field(answer, "Leastaction-Final", [&](JsonWriter& json) { write_final(json, run); });
  add_field(answer, "Leastaction-Diagnostics", [&](JsonWriter& json) { write_reports(json, outcome.diagnostics); });
  add_field(answer, "Leastaction-Events", [&](JsonWriter& json) { write_events(json, outcome.events); });
  add_field(answer, "Leastaction-Cost", [&](JsonWriter& json) { write_cost(json, outcome.cost); });
  add_field(answer, "Leastaction-Warnings", [&](JsonWriter& json) { write_warnings(json, outcome.warnings); });

  const auto& columns = run.request.columns;
  const auto& values = run.samples.values;
  std::string& out = answer.body;
  out.reserve(256 + values.size() * 20);
  std::vector<const std::vector<std::string>*> words;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) out += ',';
    out += run.problem.columns[columns[i]].name;
    words.push_back(&run.problem.columns[columns[i]].words);
  }
  out += '\n';
  for (std::size_t i = 0; i < values.size();) {
    for (const auto* known : words) {
      if (!known->empty()) {
        out += word_of(*known, values[i]);
      } else if (std::isfinite(values[i])) {
        append_number(out, values[i]);
      }
      out += ++i % columns.size() == 0 ? '\n' : ',';
    }
  }
  return answer;
}

}  // namespace least::server
