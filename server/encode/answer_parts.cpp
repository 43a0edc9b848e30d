#include "server/encode/answer_parts.hpp"

#include <algorithm>
#include <cmath>

#include "core/catalogue/backward.hpp"
#include "core/run/acts.hpp"
#include "core/text/scene.hpp"
#include "server/encode/sensitivities_out.hpp"

namespace least::server {
namespace {

void write_numbers(JsonWriter& json, const std::vector<double>& values) {
  json.open('[');
  for (const double x : values) json.number(x);
  json.close(']');
}

// told_time converts a time of the run to that of the request.
double told_time(const Request& request, double t) { return goes_backward(*request.scene) ? 0 - t : t; }

void write_limits(JsonWriter& json, const PlannedRun& run) {
  const Limits& limits = run.request.limits;
  json.open('{').key("seconds").number(limits.seconds);
  json.key("steps").integer(limits.steps).key("samples").integer(limits.samples).close('}');
}

}  // namespace

void write_asked_column(JsonWriter& json, const Request& request, std::size_t place) {
  const std::size_t known = request.scene->card().columns.size();
  if (place < known) {
    json.text(request.column(place).name);
    return;
  }
  const Measure& own = request.measures.list[place - known];
  json.open('{').key("name").text(own.card.name).key("expression").text(own.text).close('}');
}

namespace {

std::string_view direction_name(const EventAsked& asked) {
  return event_directions[asked.direction > 0 ? 0 : asked.direction < 0 ? 1 : 2];
}

// Omits the plane of a section, which is watched like an event.
void write_events_asked(JsonWriter& json, const Request& request) {
  json.open('[');
  for (std::size_t i = request.is_plane(0) ? 1 : 0; i < request.events.size(); ++i) {
    const Measure& watched = request.watched.list[i];
    const EventAsked& asked = request.events[i];
    json.open('{').key("name").text(watched.card.name).key("expression").text(watched.text);
    json.key("direction").text(direction_name(asked));
    json.key("stop").boolean(asked.stop);
    if (asked.act) {
      json.key("set").open('{');
      for (const Setting& setting : asked.act->settings) json.key(setting.name).text(setting.text);
      json.close('}');
      if (asked.act->most > 0) json.key("most").integer(asked.act->most);
    }
    json.close('}');
  }
  json.close(']');
}

struct WriteValue {
  JsonWriter& json;
  void operator()(std::monostate) const { json.null(); }
  void operator()(double x) const { json.number(x); }
  void operator()(bool x) const { json.boolean(x); }
  void operator()(const std::string& x) const { json.text(x); }
  void operator()(const std::vector<double>& x) const { write_numbers(json, x); }
  void operator()(const std::vector<Report>& x) const { write_reports(json, x); }
};

}  // namespace

void write_pictures(JsonWriter& json, const text::Pictures& pictures) {
  const auto place = [&](const std::vector<std::string>& entries) {
    json.open('[');
    for (const auto& entry : entries) json.text(entry);
    json.close(']');
  };
  if (!pictures.views.empty()) {
    json.key("views").open('[');
    for (const auto& view : pictures.views) place(view);
    json.close(']');
  }
  if (pictures.bodies.empty()) return;
  json.key("bodies").open('[');
  for (const auto& body : pictures.bodies) {
    json.open('{').key("at");
    place(body.at);
    json.key("linked").open('[');
    for (const int other : body.linked) other == text::Pictures::pivot ? json.text("pivot") : json.integer(other);
    json.close(']').key("kind").text(text::Pictures::kinds[body.kind]).close('}');
  }
  json.close(']');
}

void write_definition(JsonWriter& json, const text::Definition& written) {
  const text::Definition& given = written.typed ? written.typed->scene : written;
  const auto named = [&](std::string_view key, const text::Definition::Named& texts) {
    if (texts.empty()) return;
    json.key(key).open('{');
    for (const auto& [name, text] : texts) json.key(name).text(text);
    json.close('}');
  };
  if (!given.title.empty()) json.key("title").text(given.title);
  json.key("variables").open('[');
  for (const auto& name : given.variables) json.text(name);
  json.close(']').key("parameters").open('{');
  for (const auto& [name, value] : given.parameters) json.key(name).number(value);
  if (written.typed)
    for (const auto& [name, values] : written.typed->lists) write_numbers(json.key(name), values);
  json.close('}');
  if (written.typed) named("definitions", written.typed->definitions);
  named("equations", given.equations);
  if (given.kind != text::Definition::Kind::equations) {
    json.key(given.kind_names[static_cast<std::size_t>(given.kind)]).text(given.formula);
  }
  named("masses", given.masses);
  if (given.damping) json.key("damping").text(*given.damping);
  if (given.action_curvature) json.key("action_curvature").text(*given.action_curvature);
  if (given.offset) json.key("offset").text(*given.offset);
  named("invariants", given.invariants);
  named("forces", given.forces);
  if (given.dissipation) json.key("dissipation").text(*given.dissipation);
  if (!written.typed) return;
  if (!written.typed->note.empty()) json.key("note").text(written.typed->note);
  write_pictures(json, written.typed->pictures);
}

void write_scene(JsonWriter& json, const Scene& run) {
  const Scene& scene = forward_of(run);
  const ProblemCard& card = scene.card();
  json.key("problem").open('{').key("id").text(card.id);
  const text::TextScene* const text = scene.mechanics->text();
  if (text && !text->known) write_definition(json, text->definition);
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    write_parameter(json.key(card.parameters[i].name), card.parameters[i], scene.parameters[i]);
  }
  json.close('}').key("initial").open('{').key("t").number(scene.start);
  for (std::size_t i = 0; i < card.variables.size(); ++i) {
    if (card.variables[i].hidden) continue;
    json.key(card.variables[i].name).number(scene.initial[i]);
  }
  json.close('}');
}

void write_scheme(JsonWriter& json, const SchemeCard& card, const std::vector<double>& settings) {
  json.open('{').key("id").text(card.id);
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    write_setting(json.key(card.parameters[i].name), card, settings, i);
  }
  json.close('}');
}

void write_until(JsonWriter& json, const Request& request) {
  json.open('{');
  if (request.until_steps) {
    json.key("steps").integer(request.steps);
  } else {
    json.key("t").number(told_time(request, request.end));
  }
  json.close('}');
}

void write_record(JsonWriter& json, const Request& request) {
  const Record& record = request.record;
  json.open('{');
  switch (record.mode) {
    case Record::Mode::every:
      json.key("every").integer(record.count);
      break;
    case Record::Mode::samples:
      json.key("samples").integer(record.count);
      break;
    case Record::Mode::curve:
      json.key("curve").integer(record.count);
      break;
    case Record::Mode::times:
      json.key("times").open('[');
      for (const double t : record.times) json.number(told_time(request, t));
      json.close(']');
      break;
  }
  json.close('}');
}

void write_section_asked(JsonWriter& json, const Request& request) {
  const Section& section = *request.section;
  if (!section.plane) {
    json.key("period").number(section.period).key("phase").number(told_time(request, section.phase));
    return;
  }
  json.key("expression").text(request.watched.list[0].text).key("direction");
  json.text(direction_name(request.events[0]));
}

void write_norm(JsonWriter& json, const Request& request) {
  json.key("norm").text(norm_names[static_cast<std::size_t>(request.norm)]);
}

void write_choice(JsonWriter& json, const AdviceWithCards& choice) {
  const Advice& advice = choice.advice;
  json.open('{').key("reason").text(advice.reason.text()).key("met");
  advice.known ? json.boolean(advice.met) : json.null();
  json.key("estimated_error").number(advice.estimated_error).key("alternatives").open('[');
  for (const Alternative& other : advice.alternatives) {
    json.open('{');
    write_scheme(json.key("scheme"), choice.schemes[other.scheme.scheme], other.scheme.settings);
    json.key("force_evaluations").integer(other.force_evaluations).key("estimated_error").number(other.estimated_error);
    if (choice.timed) json.key("seconds").number(other.seconds);
    json.close('}');
  }
  json.close(']').close('}');
}

std::string_view word_of(const std::vector<std::string>& words, double code) {
  return code >= 0 && code < static_cast<double>(words.size()) ? words[static_cast<std::size_t>(code)]
                                                               : std::string_view();
}

void write_echo(JsonWriter& json, const PlannedRun& run, bool beside_findings) {
  const Request& request = run.request;
  write_scene(json, *request.scene);
  write_scheme(json.key("scheme"), run.scheme, request.settings);
  write_until(json.key("until"), request);
  write_record(json.key("record"), request);
  json.key("columns").open('[');
  for (const std::size_t place : request.columns) write_asked_column(json, request, place);
  json.close(']');
  if (request.section && !beside_findings) {
    json.key("section").open('{');
    write_section_asked(json, request);
    json.close('}');
  }
  // If the request has no events, a problem of the catalogue would apply its own: the empty list is written, too.
  const text::TextScene* const text = forward_of(*request.scene).mechanics->text();
  if ((text && text->known) || request.events.size() > (request.is_plane(0) ? 1 : 0))
    write_events_asked(json.key(beside_findings ? "events_asked" : "events"), request);
  write_limits(json.key("limits"), run);
  write_norm(json, request);
  // Among the results a member of this name exists, which includes the request.
  if (run.sensitivities && !beside_findings) write_sensitivities_asked(json.key("sensitivities"), *run.sensitivities);
}

void write_stop(JsonWriter& json, const Termination& stop) {
  json.open('{').key("reason").text(name(stop.reason)).key("detail").text(stop.detail.text());
  json.key("t").number(stop.t).key("step").integer(stop.step).key("singular_at");
  stop.singular_at ? json.number(*stop.singular_at) : json.null();
  json.close('}');
}

void write_end(JsonWriter& json, const Solution& outcome) {
  json.open('{').key("event").text(outcome.event);
  if (outcome.event_count > 0) json.key("count").integer(outcome.event_count);
  json.close('}');
}

void write_final(JsonWriter& json, const PlannedRun& run, const Solution& outcome) {
  json.open('{').key("t").number(outcome.t);
  for (std::size_t i = 0; i < run.problem.variables.size() && i < outcome.final.size(); ++i) {
    if (run.problem.variables[i].hidden) continue;
    // s, where the run did not carry it
    if (run.problem.variables[i].optional && !std::isfinite(outcome.final[i])) continue;
    json.key(run.problem.variables[i].name).number(outcome.final[i]);
  }
  json.close('}');
}

void write_reports(JsonWriter& json, const std::vector<Report>& reports) {
  const bool list =
      !reports.empty() && std::all_of(reports.begin(), reports.end(), [](const Report& r) { return r.key.empty(); });
  json.open(list ? '[' : '{');
  for (const Report& report : reports) {
    if (!list) json.key(report.key);
    std::visit(WriteValue{json}, report.value);
  }
  json.close(list ? ']' : '}');
}

void write_events(JsonWriter& json, const std::vector<Report>& events) {
  json.open('[');
  for (const Report& event : events) std::visit(WriteValue{json}, event.value);
  json.close(']');
}

void write_cost(JsonWriter& json, const Cost& cost) {
  json.open('{').key("steps").integer(cost.steps).key("force_evaluations").integer(cost.force_evaluations);
  json.key("iterations").integer(cost.iterations).key("seconds").number(cost.seconds).key("nanoseconds_per_step");
  json.number(cost.steps > 0 ? cost.seconds / static_cast<double>(cost.steps) * 1e9 : 0).close('}');
}

void write_warnings(JsonWriter& json, const std::vector<Warning>& warnings) {
  json.open('[');
  for (const Warning& warning : warnings) {
    json.open('{').key("code").text(warning.code).key("detail").text(warning.detail.text()).close('}');
  }
  json.close(']');
}

}  // namespace least::server
