#include "server/decode/plan_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/catalogue/backward.hpp"
#include "core/run/curve.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/suggestions.hpp"
#include "server/decode/columns_reader.hpp"

namespace least::server {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Span is what is known of the span of a run before it starts.
struct Span {
  std::optional<double> end;          // unknown where a scheme with its own clock takes a number of steps
  std::optional<std::int64_t> steps;  // whole steps; unknown where a scheme with its own clock runs to a time
  bool open = false;                  // the end is unknown as the scheme has its own clock
};

// fixed_step returns the index of the parameter `step`, if the scheme advances time by it.
std::optional<std::size_t> fixed_step(const SchemeCard& scheme) {
  if (scheme.own_clock) return std::nullopt;
  for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
    if (scheme.parameters[i].name == "step") return i;
  }
  return std::nullopt;
}

// The end time is at `until/t`, or at `until` itself where that is a bare time.
bool is_bare(const Json* until) { return until && (until->is_number() || until->is_string()); }
FieldPath end_path(const Json& root, const FieldPath& top) {
  const FieldPath until = top.at("until");
  return is_bare(find(root, "until")) ? until : until.at("t");
}

// run_time converts a time of the request to that of the run, which always goes forward.
double run_time(const Request& request, double t) { return goes_backward(*request.scene) ? 0 - t : t; }

// read_until reads the end as the request gives it, or sets the default.
void read_until(const Json& root, const FieldPath& top, const PresetCard* preset, Request& request) {
  const Json* json = find(root, "until");
  const FieldPath path = top.at("until");
  if (request.scene->mechanics) {
    const bool open = json == nullptr && top.faults->empty();
    request.end = request.scene->start + (open ? suggested_span(*request.scene, preset) : request.scene->card().span);
  }
  const bool bare = is_bare(json);
  if (json == nullptr || (!bare && !read_object(*json, path, {"t", "steps"}, "until"))) return;
  const Json *t = bare ? json : find(*json, "t"), *steps = bare ? nullptr : find(*json, "steps");
  if ((t == nullptr) == (steps == nullptr)) {
    path.lacks("must hold either t or steps", "{\"t\": …}, {\"steps\": …}");
    return;
  }
  if (t) {
    const auto end = read_number(*t, end_path(root, top), anywhere);
    if (end) request.end = run_time(request, *end);
  } else if (const auto count = read_integer(*steps, path.at("steps"), 1, greatest_count)) {
    request.until_steps = true;
    request.steps = *count;
  }
}

// `h` is the step length, where it is known.
Span span_until(const Json& root, const FieldPath& top, const Request& request, std::optional<double> h) {
  const FieldPath until = top.at("until"), time = end_path(root, top);
  if (request.until_steps) {
    if (!h) return {std::nullopt, request.steps};
    const double end = request.scene->start + static_cast<double>(request.steps) * *h;
    if (std::isfinite(end) && end > request.scene->start) return {end, request.steps};
    until.at("steps").fault("the run would end at a time that is no finite number after the start",
                            Json(request.steps));
    return {};
  }
  if (!(request.end > request.scene->start)) {
    const bool same = request.end == request.scene->start;
    time.fault(fmt::format("must {} the start, t = {}", same ? "differ from" : "be greater than",
                           shortest(request.scene->start)),
               Json(run_time(request, request.end)),
               same ? "" : interval({request.scene->start, infinity, true, true}));
    return {};
  }
  if (!std::isfinite(request.end - request.scene->start)) {
    time.fault("the span from the start does not fit a double", Json(run_time(request, request.end)));
    return {};
  }
  if (!h) return {request.end, std::nullopt};
  const double steps = (request.end - request.scene->start) / *h;
  // If the request does not give the end, the step is at fault.
  const auto refuse = [&](const std::string& why) {
    if (find(root, "until")) return time.fault(why, Json(run_time(request, request.end)));
    top.at("scheme").at("step").fault(
        fmt::format("is too short for the end, t = {}: {}", shortest(run_time(request, request.end)), why), Json(*h),
        "a longer step, or an until of one's own");
  };
  if (!(steps <= static_cast<double>(greatest_count))) {
    refuse(
        fmt::format("would take {} steps of {}, more than can be counted", shortest(std::floor(steps)), shortest(*h)));
    return {};
  }
  if (request.scene->start + *h == request.scene->start || request.end - *h == request.end) {
    refuse(fmt::format("a double cannot tell times apart there that lie a step of {} apart", shortest(*h)));
    return {};
  }
  return {request.end, whole_steps(request.scene->start, request.end, *h)};
}

void read_times(const Json& json, const FieldPath& path, const Request& request, const Span& span, Record& record) {
  if (!json.is_array() || json.empty()) {
    path.fault("must be a list of at least one time", json);
    return;
  }
  const double end = span.end.value_or(infinity);
  const bool backward = goes_backward(*request.scene);
  const Range within = backward ? Range{0 - end, 0 - request.scene->start}
                                : Range{request.scene->start, end, false, !std::isfinite(end)};
  double last = -infinity;
  for (std::size_t i = 0; i < json.size() && !path.faults->full(); ++i) {
    const auto t = read_number(json[i], path.at(i), within);
    if (!t) continue;
    const double here = run_time(request, *t);
    if (!(here > last))
      path.at(i).fault(backward ? "must be less than the time before it" : "must be greater than the time before it",
                       json[i]);
    last = here;
    record.times.push_back(here);
  }
}

// rows returns how many rows the run would keep; nothing where that is not known beforehand.
std::optional<std::int64_t> rows(const Request& request, const Span& span) {
  const Record& record = request.record;
  if (record.mode == Record::Mode::samples || record.mode == Record::Mode::curve) return record.count;
  if (record.mode == Record::Mode::times) return static_cast<std::int64_t>(record.times.size());
  if (record.count == 0) return 0;
  if (!span.steps) return std::nullopt;
  return 1 + std::min(*span.steps, request.limits.steps) / record.count;
}

void default_record(const Span& span, Request& request) {
  const std::int64_t most = std::max<std::int64_t>(std::min(default_samples, request.most_rows()), 1);
  if (span.steps) {
    // 1 + ⌊n/every⌋ ≤ most ⇔ every > n/most
    request.record = {Record::Mode::every, *span.steps / most + 1, {}};
  } else if (request.until_steps) {
    request.record = {Record::Mode::every, request.steps / most + 1, {}};
  } else {
    request.record = {Record::Mode::samples, std::max<std::int64_t>(most, 2), {}};
  }
}

void read_record(const Json& root, const FieldPath& top, const Span& span, Request& request) {
  default_record(span, request);
  const Json* json = find(root, "record");
  const FieldPath path = top.at("record");
  if (json == nullptr || !read_object(*json, path, {"every", "samples", "times", "curve"}, "record")) return;
  const Json *every = find(*json, "every"), *samples = find(*json, "samples"), *times = find(*json, "times"),
             *curve = find(*json, "curve");
  if ((every != nullptr) + (samples != nullptr) + (times != nullptr) + (curve != nullptr) != 1) {
    path.lacks("must hold one of every, samples, times and curve",
               "{\"every\": …}, {\"samples\": …}, {\"times\": …}, {\"curve\": …}");
    return;
  }
  Record& record = request.record;
  if (every) {
    const auto count = read_integer(*every, path.at("every"), 0, greatest_count);
    if (!count) return;
    record = {Record::Mode::every, *count, {}};
  } else if (samples) {
    const auto count = read_integer(*samples, path.at("samples"), 2, std::max<std::int64_t>(request.most_rows(), 2));
    if (!count) return;
    if (span.open) {
      path.at("samples").fault(
          "cannot be spread over a run whose end is not known beforehand: the scheme sets its own clock, and "
          "until asks for a number of its steps",
          *samples, "{\"every\": …}, {\"times\": […]}");
    }
    record = {Record::Mode::samples, *count, {}};
  } else if (curve) {
    constexpr auto most = static_cast<std::int64_t>(CurveThinner::most_asked);
    const auto count =
        read_integer(*curve, path.at("curve"), 2, std::clamp<std::int64_t>(request.most_rows(), 2, most));
    if (count) record = {Record::Mode::curve, *count, {}};
  } else {
    record = {Record::Mode::times, 0, {}};
    read_times(*times, path.at("times"), request, span, record);
  }
  if (const auto kept = rows(request, span); kept && *kept > request.most_rows()) {
    path.at(every     ? "every"
            : samples ? "samples"
            : curve   ? "curve"
                      : "times")
        .fault(fmt::format("would keep {} rows of {} columns, more numbers than limits.samples = {}", *kept,
                           request.columns.size(), request.limits.samples),
               every     ? *every
               : samples ? *samples
               : curve   ? *curve
                         : Json());
  }
}

bool fault_free(const FieldPath& top, std::initializer_list<const char*> pointers) {
  return top.faults->empty() ||
         std::none_of(pointers.begin(), pointers.end(), [&](const char* pointer) { return top.faults->at(pointer); });
}

}  // namespace

void read_limits(const Json& root, const FieldPath& top, const Caps& caps, Limits& limits) {
  limits.seconds = std::min(limits.seconds, caps.seconds);
  limits.steps = std::min(limits.steps, caps.steps);
  limits.samples = std::min(limits.samples, caps.samples);
  const Json* json = find(root, "limits");
  const FieldPath path = top.at("limits");
  if (json == nullptr || !read_object(*json, path, {"seconds", "steps", "samples"}, "limits")) return;
  if (const Json* seconds = find(*json, "seconds")) {
    const auto value = read_number(*seconds, path.at("seconds"), {0, caps.seconds, true, false});
    limits.seconds = value.value_or(limits.seconds);
  }
  if (const Json* steps = find(*json, "steps")) {
    limits.steps = read_integer(*steps, path.at("steps"), 1, caps.steps).value_or(limits.steps);
  }
  if (const Json* samples = find(*json, "samples")) {
    limits.samples = read_integer(*samples, path.at("samples"), 2, caps.samples).value_or(limits.samples);
  }
}

void refuse_steps(const Json& root, const FieldPath& top, std::string_view reason) {
  const Json* until = find(root, "until");
  const Json* steps = until && until->is_object() ? find(*until, "steps") : nullptr;
  if (steps) top.at("until").at("steps").fault(std::string(reason), *steps, "{\"t\": …}");
}

void read_direction(const Json& root, const FieldPath& top, Scene& scene) {
  const Json* json = find(root, "until");
  const Json* t = is_bare(json) ? json : json && json->is_object() ? find(*json, "t") : nullptr;
  if (t == nullptr) return;
  Faults later;  // its faults are reported when it is read again
  const auto end = read_number(*t, FieldPath{"", &later}, anywhere);
  if (!end || !(*end < scene.start)) return;
  auto turned = backward(scene);
  const auto* why = std::get_if<std::string>(&turned);
  if (!why)
    scene = std::get<Scene>(std::move(turned));
  else if (top.faults->empty())  // otherwise the faults found so far may be the reason
    end_path(root, top).fault("lies before the start: " + *why, *t);
}

void read_end(const Json& root, const FieldPath& top, const ProblemCard* problem, const PresetCard* preset,
              Request& request) {
  read_until(root, top, preset, request);
  if (problem && fault_free(top, {"/problem/preset", "/initial/t", "/until", "/until/t", "/until/steps"})) {
    span_until(root, top, request, std::nullopt);
  }
}

void read_norm(const Json& root, const FieldPath& top, Request& request) {
  const Json* json = find(root, "norm");
  if (json == nullptr) return;
  const Names names(norm_names.begin(), norm_names.end());
  request.norm = static_cast<Norm>(read_name(*json, top.at("norm"), names, "norm").value_or(0));
}

void read_plan(const Json& root, const FieldPath& top, const ProblemCard* problem, const SchemeCard* scheme,
               const PresetCard* preset, const Caps& caps, const Members* members, Request& request) {
  read_limits(root, top, caps, request.limits);
  read_until(root, top, preset, request);
  Span span;
  if (problem && scheme && fault_free(top, {"/problem/preset", "/initial/t", "/until", "/until/t", "/until/steps"})) {
    const auto step = fixed_step(*scheme);
    const bool known = step && fault_free(top, {"/scheme/step", "/scheme/preset"});
    span = span_until(root, top, request, known ? std::optional(request.settings[*step]) : std::nullopt);
    span.open = request.until_steps && !step;
  }
  if (problem) read_columns(root, top, members, request);  // the number of columns limits the number of rows
  read_record(root, top, span, request);
}

}  // namespace least::server
