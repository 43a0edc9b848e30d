#include "server/encode/study_json.hpp"

#include "core/catalogue/backward.hpp"
#include "core/catalogue/catalogue.hpp"
#include "server/encode/answer_parts.hpp"

namespace least::server {
namespace {

void write(JsonWriter& json, const Cards& cards, const SchemeConfig& choice) {
  write_scheme(json, cards.schemes[choice.scheme], choice.settings);
}

// ran returns the scheme as it ran for a point: with the value of the varied setting; the time step is scaled along
// with θ.
SchemeConfig ran(const Cards& cards, const StudyCurve& curve, const StudyPoint& point) {
  SchemeConfig choice = curve.scheme;
  const auto& parameters = cards.schemes[choice.scheme].parameters;
  double ratio = 1;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name != curve.setting) continue;
    ratio = point.value / choice.settings[i];
    choice.settings[i] = point.value;
  }
  for (std::size_t i = 0; i < parameters.size() && curve.setting == "theta"; ++i) {
    if (parameters[i].name == "step") choice.settings[i] *= ratio;
  }
  return choice;
}

void write_point(JsonWriter& json, const StudyPoint& point) {
  json.open('{').key("value").number(point.value).key("step").number(point.step).key("error").number(point.error);
  json.key("force_evaluations").integer(point.force_evaluations).key("seconds").number(point.seconds);
  json.key("status").text(name(point.status)).close('}');
}

// `points` is false for the last line of NDJSON, whose reader has received them.
void write_curves(JsonWriter& json, const PlanWithCards& planned, const least::Study& study, bool points) {
  json.open('[');
  for (const StudyCurve& curve : study.curves) {
    write(json.open('{').key("scheme"), planned.cards, curve.scheme);
    json.key("setting").text(curve.setting);
    if (points) {
      json.key("points").open('[');
      for (const StudyPoint& point : curve.points) write_point(json, point);
      json.close(']');
    }
    json.key("observed_order").number(curve.observed_order).key("expected_order");
    curve.expected_order > 0 ? json.integer(curve.expected_order) : json.null();
    if (!curve.why.empty()) json.key("why").text(curve.why);
    json.close('}');
  }
  json.close(']');
}

void write_pareto(JsonWriter& json, const PlanWithCards& planned, const least::Study& study) {
  json.open('[');
  for (const ParetoPoint& best : study.pareto) {
    const StudyCurve& curve = study.curves[best.curve];
    const StudyPoint& point = curve.points[best.point];
    json.open('{').key("error").number(point.error).key("seconds").number(point.seconds);
    json.key("force_evaluations").integer(point.force_evaluations);
    write(json.key("scheme"), planned.cards, ran(planned.cards, curve, point));
    json.key("curve").integer(static_cast<std::int64_t>(best.curve));
    json.key("point").integer(static_cast<std::int64_t>(best.point));
    json.key("fewest_forces").boolean(best.fewest_forces).key("fastest").boolean(best.fastest).close('}');
  }
  json.close(']');
}

void write_left_out(JsonWriter& json, const Scene& scene, const std::vector<Message>& left_out) {
  json.open('[');
  for (Message what : left_out) {
    if (goes_backward(scene)) what.turn_times();
    json.text(what.text());
  }
  json.close(']');
}

void write_status(JsonWriter& json, ReturnCode end) {
  json.key("status").text(end == ReturnCode::completed ? "completed" : "stopped");
  if (end != ReturnCode::completed) json.key("stop").open('{').key("reason").text(name(end)).close('}');
}

void write_study_echo(JsonWriter& json, const PlanWithCards& planned) {
  const StudyPlan& plan = planned.plan;
  json.key("version").text(version);
  write_scene(json, *plan.scene.scene);
  write_until(json.key("until"), plan.scene);
  json.key("error").text(plan.at_end ? "final" : "max");
  write_norm(json, plan.scene);
  json.key("budget_seconds").number(plan.budget_seconds);
}

void write_truth(JsonWriter& json, const PlanWithCards& planned, const least::Study& study) {
  json.key("reference").open('{').key("how").text(study.how).key("uncertainty").number(study.uncertainty).close('}');
  json.key("floor").number(study.floor).key("growth").number(study.growth).key("chaotic").boolean(study.chaotic);
  json.key("end").number(sign_of(*planned.plan.scene.scene, "t") * study.end);
}

void write_findings(JsonWriter& json, const PlanWithCards& planned, const least::Study& study, ReturnCode end,
                    bool points) {
  write_curves(json.key("curves"), planned, study, points);
  write_pareto(json.key("pareto"), planned, study);
  write_left_out(json.key("left_out"), *planned.plan.scene.scene, study.left_out);
  write_status(json, end == ReturnCode::completed ? study.stop : end);
}

// An object as a line.
template <class WriteMembers>
std::string line(WriteMembers write_members) {
  std::string text;
  JsonWriter json(text);
  json.open('{');
  write_members(json);
  json.close('}');
  return text += '\n';
}

}  // namespace

std::string encode_study(const PlanWithCards& planned, const least::Study& study, ReturnCode end) {
  return line([&](JsonWriter& json) {
    write_study_echo(json, planned);
    write_truth(json, planned, study);
    write_findings(json, planned, study, end, true);
  });
}

std::string encode_study_head(const PlanWithCards& planned, const least::Study& study) {
  return line([&](JsonWriter& json) {
    json.key("kind").text("head");
    write_study_echo(json, planned);
    write_truth(json, planned, study);
    json.key("schemes").open('[');
    for (const SchemeConfig& choice : planned.plan.schemes) write(json, planned.cards, choice);
    json.close(']');
  });
}

std::string encode_study_point(const PlanWithCards& planned, std::size_t index, const StudyCurve& curve) {
  return line([&](JsonWriter& json) {
    json.key("kind").text("point").key("curve").integer(static_cast<std::int64_t>(index));
    write(json.key("scheme"), planned.cards, curve.scheme);
    json.key("setting").text(curve.setting);
    write_point(json.key("point"), curve.points.back());
  });
}

std::string encode_study_end(const PlanWithCards& planned, const least::Study& study, ReturnCode end) {
  return line([&](JsonWriter& json) {
    json.key("kind").text("end");
    write_findings(json, planned, study, end, false);
  });
}

std::string encode_stability(const StabilityFindings& findings, ReturnCode end) {
  const auto& [scene, schemes, limits, cards] = findings;
  return line([&](JsonWriter& json) {
    json.key("version").text(version);
    write_scene(json, *scene.scene);
    json.key("limits").open('[');
    for (const StabilityLimit& limit : limits) {
      write(json.open('{').key("scheme"), cards, limit.scheme);
      json.key("step").number(limit.step).key("failure");
      limit.failure.empty() ? json.null() : json.text(limit.failure);
      json.key("theory").number(limit.theory).key("islands").open('[');
      for (const Interval& island : limit.islands) json.open('[').number(island.low).number(island.high).close(']');
      json.close(']');
      if (!limit.why.empty()) json.key("why").text(limit.why);
      json.close('}');
    }
    json.close(']');
    std::vector<Message> left_out;
    for (std::size_t i = limits.size(); i < schemes.size(); ++i) {
      left_out.push_back(name(cards.schemes[schemes[i].scheme], schemes[i]) + ": no time was left");
    }
    write_left_out(json.key("left_out"), *scene.scene, left_out);
    write_status(json, end);
  });
}

}  // namespace least::server
