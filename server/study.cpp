#include "server/study.hpp"

#include <memory>

#include "server/decode/study_request.hpp"
#include "server/encode/problem_document.hpp"
#include "server/encode/study_json.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

// The core keeps to its budget between runs; beyond this much more of it, in seconds, it is cut off.
constexpr double margin = 1;

Answer measured_as_a_whole(const Context& context, const Question& question, const StudyPlan& plan) {
  const Watch watch(context.cancelled, question.gone, plan.budget_seconds + margin);
  const auto study = work_precision(
      plan, [](std::size_t, const StudyCurve&) { return true; }, watch.cancelled());
  return {200, "application/json", encode_study({plan, context.cards}, study, watch.reason()), {}};
}

// Nothing of the study is kept for the client: each line leaves as it comes, and a client that takes no more ends it.
class Lines {
 public:
  Lines(const Context& context, StudyPlan&& plan, const Question& question, Gate::Pass&& pass)
      : context_(context), plan_(std::move(plan)), gone_(question.gone), pass_(std::move(pass)) {}

  bool operator()(const Write& write) {
    const Asked asked{plan_, context_.cards};
    bool begun = false, taken = true;
    const auto head = [&](const least::Study& known) {
      begun = true;
      taken = write(encode_study_head(asked, known));
    };
    const auto seen = [&](std::size_t index, const StudyCurve& curve) {
      return taken && (taken = write(encode_study_point(asked, index, curve)));
    };
    plan_.begun = head;
    const Watch watch(context_.cancelled, gone_, plan_.budget_seconds + margin);
    const auto study = work_precision(plan_, seen, watch.cancelled());
    pass_.reset();            // who has read the end finds the place free
    if (!begun) head(study);  // it ended before it began
    return taken && write(encode_study_end(asked, study, watch.reason()));
  }

 private:
  const Context& context_;
  StudyPlan plan_;
  std::function<bool()> gone_;
  std::optional<Gate::Pass> pass_;
};

Answer measured_in_lines(const Context& context, const Question& question, StudyPlan&& plan, Gate::Pass&& pass) {
  Answer answer{200, "application/x-ndjson", {}, {}};
  const auto lines = std::make_shared<Lines>(context, std::move(plan), question, std::move(pass));
  answer.stream = [lines](const Write& write) { return (*lines)(write); };
  return answer;
}

}  // namespace

Answer measure_work_precision(const Context& context, const Question& question) {
  auto form = form_for(question, {"application/json", "application/x-ndjson"});
  if (!form) return form.error();
  auto parsed = json_of(question);
  if (!parsed) return parsed.error();
  auto plan = decode_work_precision(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), question.id);
  auto pass = turn(context);
  if (!pass) return busy(question);
  return *form == 0 ? measured_as_a_whole(context, question, *plan)
                    : measured_in_lines(context, question, std::move(*plan), std::move(*pass));
}

Answer measure_stability(const Context& context, const Question& question) {
  auto form = form_for(question, {"application/json"});
  if (!form) return form.error();
  auto parsed = json_of(question);
  if (!parsed) return parsed.error();
  const auto plan = decode_stability(std::move(*parsed), context.cards, context.caps);
  if (!plan) return problem_document(plan.error(), question.id);
  const auto pass = turn(context);
  if (!pass) return busy(question);
  const Watch watch(context.cancelled, question.gone, plan->scene.limits.seconds);
  std::vector<StabilityLimit> limits;
  for (const Choice& scheme : plan->schemes) {
    auto limit = longest_stable_step_of(plan->scene, scheme, watch.cancelled());
    if (watch.cancelled()) break;  // a search that was cut off found nothing
    limits.push_back(std::move(limit));
  }
  return {200, "application/json", encode_stability(*plan, context.cards, limits, watch.reason()), {}};
}

}  // namespace least::server
