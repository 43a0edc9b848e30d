#include "server/encode/sensitivities_out.hpp"

#include "core/text/start_velocities.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

using variations::SensitivitiesAsked;

// Writes a list for each row; null where nothing was found.
void write_slopes(JsonWriter& json, const variations::Slopes& slopes, std::size_t rows) {
  if (slopes.empty()) {
    json.null();
    return;
  }
  const std::size_t width = slopes.size() / rows;
  json.open('[');
  for (std::size_t i = 0; i < rows; ++i) {
    json.open('[');
    for (std::size_t k = 0; k < width; ++k) json.number(slopes[i * width + k]);
    json.close(']');
  }
  json.close(']');
}

void write_settings(JsonWriter& json, const SensitivitiesAsked& asked) {
  json.key("order")
      .integer(asked.order)
      .key("of")
      .text(variations::map_names[asked.of_scheme ? 1 : 0])
      .key("at")
      .text(asked.at_samples ? "samples" : "final");
  if (!asked.whole_start) json.key("holds").text(text::held_names[asked.keeps_velocities ? 1 : 0]);
}

}  // namespace

void write_sensitivities_asked(JsonWriter& json, const SensitivitiesAsked& asked) {
  json.open('{').key("by");
  if (asked.whole_start) {
    json.text("initial");
  } else {
    write_texts(json, asked.names);
  }
  write_settings(json, asked);
  json.close('}');
}

namespace {

// Writes the members before the samples.
void write_beginning(JsonWriter& json, const FoundSensitivities& of) {
  const variations::Sensitivities& found = of.found;
  const std::size_t rows = found.rows.size();
  write_texts(json.open('{').key("by"), of.asked.names);
  write_texts(json.key("rows"), found.rows);
  write_settings(json, of.asked);
  write_slopes(json.key("final"), found.final, rows);
  if (of.asked.order == 2) {
    json.key("second").open('{').key("pairs").open('[');
    for (const auto& [a, b] : found.pairs)
      json.open('[').integer(static_cast<std::int64_t>(a)).integer(static_cast<std::int64_t>(b)).close(']');
    write_slopes(json.close(']').key("final"), found.second, rows);
    json.close('}');
  }
}

// Writes the members after the samples.
void write_ending(JsonWriter& json, const FoundSensitivities& of) {
  const variations::Sensitivities& found = of.found;
  json.key("events").open('[');
  for (const auto& [name, slopes] : found.events) {
    json.open('{').key("name").text(name).key("t").open('[');
    for (const double slope : slopes) json.number(slope);
    json.close(']').close('}');
  }
  json.close(']');
  if (of.asked.whole_start) {
    json.key("structure");
    found.structure.empty() ? (void)json.null() : write_reports(json, found.structure);
  }
  json.key("uncertainty").number(found.uncertainty);
  if (!found.reason.empty()) json.key("reason").text(found.reason);
  json.close('}');
}

}  // namespace

void begin_sensitivities(JsonWriter& json, const FoundSensitivities& found) {
  write_beginning(json, found);
  json.key("samples").open('[');
}

void write_samples(JsonWriter& json, const FoundSensitivities& of, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k) write_slopes(json, of.found.samples[k], of.found.rows.size());
}

void end_sensitivities(JsonWriter& json, const FoundSensitivities& found) {
  json.close(']');
  write_ending(json, found);
}

void write_sensitivities(JsonWriter& json, const FoundSensitivities& found, bool with_samples) {
  if (!found.asked.at_samples || !with_samples) {
    write_beginning(json, found);
    return write_ending(json, found);
  }
  begin_sensitivities(json, found);
  write_samples(json, found, 0, found.found.samples.size());
  end_sensitivities(json, found);
}

}  // namespace least::server
