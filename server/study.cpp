#include "server/study.hpp"

#include <memory>
#include <optional>
#include <string>

#include "server/decode/study_request.hpp"
#include "server/encode/problem_document.hpp"
#include "server/encode/study_json.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

// The core checks its budget between runs; it is cut off when it exceeds the budget by this many seconds.
constexpr double margin = 1;

Answer measured_as_a_whole(const Context& context, const HttpRequest& request, const StudyPlan& plan) {
  const CancellationWatch watch(context.cancelled, request.gone, plan.budget_seconds + margin);
  const auto study = work_precision(
      plan, [](std::size_t, const StudyCurve&) { return true; }, watch.cancelled());
  return {200, "application/json", encode_study({plan, context.cards}, study, end_of(watch)), {}};
}

// Keeps nothing for the client: each line is sent as it comes, and a client that takes no more ends the study.
class StudyStream {
 public:
  StudyStream(const Context& context, StudyPlan&& plan, const HttpRequest& request, Admission::Pass&& pass)
      : context_(context), plan_(std::move(plan)), gone_(request.gone), pass_(std::move(pass)) {}

  std::optional<std::string> operator()(const Write& write) {
    const PlanWithCards planned{plan_, context_.cards};
    bool begun = false, taken = true;
    const auto head = [&](const least::Study& known) {
      begun = true;
      taken = write(encode_study_head(planned, known));
    };
    const auto seen = [&](std::size_t index, const StudyCurve& curve) {
      return taken && (taken = write(encode_study_point(planned, index, curve)));
    };
    plan_.begun = head;
    const CancellationWatch watch(context_.cancelled, gone_, plan_.budget_seconds + margin);
    const auto study = work_precision(plan_, seen, watch.cancelled());
    if (!begun) head(study);  // the study ended before it began
    pass_.reset();            // the place is free before the client can have read the end
    return encode_study_end(planned, study, taken ? end_of(watch) : ReturnCode::cancelled);
  }

 private:
  const Context& context_;
  StudyPlan plan_;
  std::function<bool()> gone_;
  std::optional<Admission::Pass> pass_;
};

Answer measured_in_lines(const Context& context, const HttpRequest& request, StudyPlan&& plan, Admission::Pass&& pass) {
  Answer answer{200, "application/x-ndjson", {}, {}};
  const auto stream = std::make_shared<StudyStream>(context, std::move(plan), request, std::move(pass));
  answer.begins = "{";
  answer.stream = [stream](const Write& write) { return (*stream)(write); };
  return answer;
}

Answer measured_stability(const Context& context, const HttpRequest& request, const StabilityPlan& plan) {
  const CancellationWatch watch(context.cancelled, request.gone, plan.scene.limits.seconds);
  std::vector<StabilityLimit> limits;
  for (const SchemeConfig& scheme : plan.schemes) {
    auto limit = longest_stable_step_of(plan.scene, scheme, watch.cancelled());
    if (watch.cancelled()) break;  // a search that was cut off has found nothing
    limits.push_back(std::move(limit));
  }
  return {
      200, "application/json", encode_stability({plan.scene, plan.schemes, limits, context.cards}, end_of(watch)), {}};
}

}  // namespace

Prepared measure_work_precision(const Context& context, const HttpRequest& request) {
  auto form = form_for(request, {"application/json", "application/x-ndjson"});
  if (!form) return form.error();
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  auto plan = decode_work_precision(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), request.id);
  return Job([&context, request, lines = *form == 1,
              shared = std::make_shared<StudyPlan>(std::move(*plan))](Admission::Pass pass) {
    pass.may_take(shared->budget_seconds + margin);
    return lines ? measured_in_lines(context, request, std::move(*shared), std::move(pass))
                 : measured_as_a_whole(context, request, *shared);
  });
}

Prepared measure_stability(const Context& context, const HttpRequest& request) {
  auto form = form_for(request, {"application/json"});
  if (!form) return form.error();
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  auto plan = decode_stability(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), request.id);
  return Job(
      [&context, request, shared = std::make_shared<const StabilityPlan>(std::move(*plan))](Admission::Pass pass) {
        pass.may_take(shared->scene.limits.seconds);
        return measured_stability(context, request, *shared);
      });
}

}  // namespace least::server
