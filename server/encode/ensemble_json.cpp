#include "server/encode/ensemble_json.hpp"

#include <fmt/format.h>

#include <numeric>

#include "core/catalogue/catalogue.hpp"
#include "core/run/messages.hpp"
#include "core/text/scene.hpp"
#include "core/text/start_velocities.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

const ColumnCard& column_of(const EnsemblePlan& plan, std::size_t k) {
  return plan.request.column(plan.request.columns[k]);
}

void write_integers(JsonWriter& json, const std::vector<std::int64_t>& values) {
  json.open('[');
  for (const auto value : values) json.integer(value);
  json.close(']');
}
void write_list(JsonWriter& json, const std::vector<double>& values) {
  json.open('[');
  for (const double value : values) json.number(value);
  json.close(']');
}
void write_members(JsonWriter& json, const EnsemblePlan& plan) {
  const Members& members = plan.members;
  const ProblemCard& problem = plan.request.scene->card();
  json.open('{').key("count").integer(members.count).key("seed").integer(static_cast<std::int64_t>(members.seed));
  json.key("vary").open('{');
  for (const Variation& varied : members.vary) {
    const std::string name = varied.is_parameter()           ? problem.parameters[varied.index].name
                             : varied.of == Varied::velocity ? text::velocity_name(problem.variables[varied.index].name)
                                                             : problem.variables[varied.index].name;
    json.key((varied.is_parameter() ? "/problem/" : "/initial/") + name);
    json.open('{').key(spread_names[static_cast<std::size_t>(varied.spread)]);
    write_list(json, varied.numbers);
    json.close('}');
  }
  json.close('}');
  const text::TextScene* const text = plan.request.scene->mechanics->text();
  if (text && text->takes_velocities()) json.key("holds").text(text::held_names[members.holds_velocities ? 1 : 0]);
  json.close('}');
}

void write_histogram_asked(JsonWriter& json, const HistogramAsked& asked) {
  json.key("range").open('[').number(asked.low).number(asked.high).close(']').key("bins").integer(asked.bins);
}

// The request with all defaults, except for members that share their name with a result.
void write_ensemble_echo(JsonWriter& json, const EnsemblePlan& plan, const Cards& cards) {
  const Request& request = plan.request;
  json.key("version").text(version);
  write_scene(json, *request.scene);
  write_scheme(json.key("scheme"), cards.schemes[request.scheme], request.settings);
  write_until(json.key("until"), request);
  const Limits& limits = request.limits;
  json.key("limits").open('{').key("seconds").number(limits.seconds).key("steps").integer(limits.steps);
  json.key("samples").integer(limits.samples).close('}');
  write_members(json.key("members"), plan);
  json.key("range").open('[').integer(plan.first).integer(plan.last).close(']').key("columns").open('[');
  for (const std::size_t place : request.columns) write_asked_column(json, request, place);
  json.close(']');
  if (plan.trajectories) write_record(json.key("record"), request);
  json.key("keep").open('[');
  if (plan.statistics) json.text("statistics");
  if (plan.final) json.text("final");
  if (plan.request.section) json.text("section");
  if (plan.trajectories) json.text("trajectories");
  json.close(']');
}

void write_endings(JsonWriter& json, const Endings& ended) {
  json.key("completed").integer(ended[0]).key("stopped").open('{');
  for (std::size_t i = 1; i < ended.size(); ++i) {
    if (ended[i] > 0) json.key(name(static_cast<ReturnCode>(i))).integer(ended[i]);
  }
  json.close('}');
}

void write_statistics(JsonWriter& json, const EnsemblePlan& plan, const Harvest& all) {
  if (plan.statistics) {
    json.key("statistics").open('{');
    for (std::size_t k = 0; k < plan.request.columns.size(); ++k) {
      const Moments moments = k < all.columns.size() ? all.columns[k] : Moments{};
      const bool some = moments.count > 0;
      json.key(column_of(plan, k).name).open('{').key("mean");
      some ? json.number(moments.mean) : json.null();
      // NaN is written as null, also for the extremes where there are no values
      json.key("variance").number(moments.variance());
      json.key("minimum").number(moments.minimum).key("maximum").number(moments.maximum).close('}');
    }
    json.close('}');
  }
  if (plan.histograms.empty()) return;
  json.key("histograms").open('{');
  for (std::size_t i = 0; i < plan.histograms.size(); ++i) {
    const HistogramAsked& asked = plan.histograms[i];
    Histogram counted = i < all.histograms.size() ? all.histograms[i] : Histogram{};
    counted.counts.resize(static_cast<std::size_t>(asked.bins));
    write_histogram_asked(json.key(column_of(plan, asked.column).name).open('{'), asked);
    write_integers(json.key("counts"), counted.counts);
    json.key("below").integer(counted.below).key("above").integer(counted.above).close('}');
  }
  json.close('}');
}

void add_ends(TextPieces& pieces, const EnsemblePlan& plan, const Harvest& harvest) {
  if (!plan.final) return;
  const std::size_t columns = plan.request.columns.size();
  pieces.add(false, [](JsonWriter& json) { json.key("final").open('{'); });
  pieces.add_list("index", true, harvest.final_member);
  for (std::size_t k = 0; k < columns; ++k)
    pieces.add_list(column_of(plan, k).name, false, Strided{harvest.final, k, columns});
  pieces.add(false, [](JsonWriter& json) { json.close('}'); });
}
void add_points(TextPieces& pieces, const EnsemblePlan& plan, const SectionPoints& points, bool asked) {
  if (!plan.request.section) return;
  const std::size_t columns = plan.request.columns.size();
  pieces.add(false, [&plan, asked](JsonWriter& json) {
    json.key("section").open('{');
    if (asked) write_section_asked(json, plan.request);
  });
  pieces.add_list("member", !asked, points.member);
  pieces.add_list("crossing", false, points.crossing);
  pieces.add_list("t", false, Strided{points.t, 0, 1});
  for (std::size_t k = 0; k < columns; ++k) {
    if (column_of(plan, k).name == "t") continue;  // a section has a column t of its own
    pieces.add_list(column_of(plan, k).name, false, Strided{points.values, k, columns});
  }
  pieces.add(false, [](JsonWriter& json) { json.close('}'); });
}

void add_trajectories(TextPieces& pieces, const EnsemblePlan& plan, const Trajectories& all) {
  if (!plan.trajectories) return;
  const std::size_t columns = plan.request.columns.size();
  pieces.add(false, [](JsonWriter& json) { json.key("trajectories").open('{'); });
  pieces.add_list("member", true, all.member);
  for (std::size_t k = 0; k < columns; ++k)
    pieces.add_lists(column_of(plan, k).name, Strided{all.values, k, columns}, all.rows);
  pieces.add(false, [](JsonWriter& json) { json.close('}'); });
}

void write_status(JsonWriter& json, const Harvest& all, const EnsembleEnd& end) {
  json.key("status").text(end.reason == ReturnCode::completed ? "completed" : "stopped");
  if (end.reason == ReturnCode::completed) return;
  std::int64_t members = 0;
  for (const auto count : all.ended) members += count;
  json.key("stop").open('{').key("reason").text(name(end.reason)).key("members").integer(members).close('}');
}

/// counted_values returns how many values of column k, of members that completed, are in the statistics and histograms:
/// those that are finite. All, where there is neither a statistic nor a histogram of this column.
std::int64_t counted_values(const EnsemblePlan& plan, const Harvest& all, std::size_t k) {
  if (k < all.columns.size()) return all.columns[k].count;
  for (std::size_t i = 0; i < std::min(plan.histograms.size(), all.histograms.size()); ++i)
    if (plan.histograms[i].column == k) {
      const Histogram& counted = all.histograms[i];
      return std::accumulate(counted.counts.begin(), counted.counts.end(), counted.below + counted.above);
    }
  return all.ended[static_cast<std::size_t>(ReturnCode::completed)];
}

void write_ensemble_cost(JsonWriter& json, const EnsemblePlan& plan, const Harvest& all, const EnsembleEnd& end) {
  Cost cost = all.cost;
  cost.seconds = end.seconds;
  write_cost(json.key("cost"), cost);
  std::vector<Warning> warnings = end.warnings;
  if (all.truncated) {
    warnings.push_back({"section_truncated", messages::section_truncated(plan.request.limits.samples)});
  }
  if (all.unresolved > 0)
    warnings.push_back({"events_unresolved", messages::unresolved_members(plan.request.watched.list[0].text,
                                                                          all.unresolved, all.first_unresolved)});
  if (plan.statistics || !plan.histograms.empty()) {
    const std::int64_t completed = all.ended[static_cast<std::size_t>(ReturnCode::completed)];
    for (std::size_t k = 0; k < plan.request.columns.size(); ++k)
      if (const std::int64_t counted = counted_values(plan, all, k); counted < completed)
        warnings.push_back(
            {"values_not_finite", messages::values_left_out(column_of(plan, k).name, completed - counted, completed)});
  }
  write_warnings(json.key("warnings"), warnings);
}

// An object; in JSON a line.
template <class WriteMembers>
std::string ensemble_line(WriteMembers write_all) {
  std::string text;
  JsonWriter json(text);
  json.open('{');
  write_all(json);
  json.close('}');
  return text += '\n';
}
void close_line(JsonWriter& json) {
  json.close('}');
  if (json.notation() == Notation::json) json.buffer() += '\n';
}

}  // namespace

TextPieces pieces_of_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                              Notation notation) {
  TextPieces pieces(notation);
  pieces.add(true, [&](JsonWriter& json) {
    json.open('{');
    write_ensemble_echo(json, plan, cards);
    write_status(json, all, end);
    write_endings(json, all.ended);
    write_statistics(json, plan, all);
  });
  add_ends(pieces, plan, all);
  add_points(pieces, plan, all.section, true);
  add_trajectories(pieces, plan, all.trajectories);
  pieces.add(false, [&](JsonWriter& json) {
    write_ensemble_cost(json, plan, all, end);
    close_line(json);
  });
  return pieces;
}

std::string encode_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                            Notation notation) {
  return pieces_of_ensemble(plan, cards, all, end, notation).whole();
}

std::string encode_ensemble_head(const EnsemblePlan& plan, const Cards& cards) {
  return ensemble_line([&](JsonWriter& json) {
    json.key("kind").text("head");
    write_ensemble_echo(json, plan, cards);
    if (plan.request.section) {
      json.key("section").open('{');
      write_section_asked(json, plan.request);
      json.close('}');
    }
    if (plan.histograms.empty()) return;
    json.key("histograms").open('{');
    for (const HistogramAsked& asked : plan.histograms) {
      write_histogram_asked(json.key(column_of(plan, asked.column).name).open('{'), asked);
      json.close('}');
    }
    json.close('}');
  });
}

TextPieces pieces_of_block(const EnsemblePlan& plan, const Block& block) {
  const Harvest& harvest = block.harvest;
  TextPieces pieces(Notation::json);
  pieces.add(true, [&](JsonWriter& json) {
    json.open('{').key("kind").text("block").key("block").integer(block.index).key("first").integer(block.first);
    json.key("members").integer(block.count);
    write_endings(json, harvest.ended);
    if (plan.statistics) {
      json.key("sums").open('{');
      for (std::size_t k = 0; k < harvest.columns.size(); ++k) {
        const Moments& of = harvest.columns[k];
        json.key(column_of(plan, k).name).open('[').integer(of.count).number(of.mean).number(of.squares);
        json.number(of.minimum).number(of.maximum).close(']');
      }
      json.close('}');
    }
    if (plan.histograms.empty()) return;
    json.key("histograms").open('{');
    for (std::size_t i = 0; i < harvest.histograms.size(); ++i) {
      const Histogram& of = harvest.histograms[i];
      write_integers(json.key(column_of(plan, plan.histograms[i].column).name).open('{').key("counts"), of.counts);
      json.key("below").integer(of.below).key("above").integer(of.above).close('}');
    }
    json.close('}');
  });
  add_ends(pieces, plan, harvest);
  add_points(pieces, plan, harvest.section, false);
  add_trajectories(pieces, plan, harvest.trajectories);
  pieces.add(false, [&](JsonWriter& json) {
    json.key("truncated").boolean(harvest.truncated).key("unresolved").integer(harvest.unresolved);
    json.key("first_unresolved").integer(harvest.first_unresolved).key("steps").integer(harvest.cost.steps);
    json.key("force_evaluations").integer(harvest.cost.force_evaluations);
    close_line(json);
  });
  return pieces;
}

std::string encode_ensemble_end(const EnsemblePlan& plan, const Harvest& all, const EnsembleEnd& end) {
  return ensemble_line([&](JsonWriter& json) {
    json.key("kind").text("end");
    write_status(json, all, end);
    write_endings(json, all.ended);
    write_statistics(json, plan, all);
    write_ensemble_cost(json, plan, all, end);
  });
}

}  // namespace least::server
