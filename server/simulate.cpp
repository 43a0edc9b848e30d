#include "server/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/catalogue/backward.hpp"
#include "core/catalogue/catalogue.hpp"
#include "core/run/messages.hpp"
#include "core/variations/varied_run.hpp"
#include "server/decode/field_reader.hpp"
#include "server/encode/answer_parts.hpp"
#include "server/encode/problem_document.hpp"
#include "server/encode/run_answer.hpp"
#include "server/http/cancellation.hpp"
#include "server/http/request_reader.hpp"

namespace least::server {
namespace {

constexpr std::string_view in_lines = "application/x-ndjson";

// Ended is the result of a run.
struct Ended {
  Solution outcome;
  std::optional<variations::Sensitivities> sensitivities;  // nothing where none are asked for

  const variations::Sensitivities* slopes() const { return sensitivities ? &*sensitivities : nullptr; }
  std::size_t numbers_of_slopes() const {
    if (!sensitivities || sensitivities->samples.empty()) return 0;
    return sensitivities->samples.size() * sensitivities->samples.front().size();
  }
  // Charges the text of all slopes at samples; where memory is short, they are left out.
  void hold_text_of_slopes() {
    constexpr std::size_t copies = 2;  // the text written, and the text on its way
    if (!sensitivities || sensitivities->held.grow_by(copies * numbers_of_slopes() * (longest_number + 1))) return;
    sensitivities->samples = {};
    sensitivities->reason = "there is no room for the text of those at samples: other forms are written piece by piece";
  }
};

// Task is a run, planned or finished, with the advice if its scheme was chosen. Not movable.
class Task {
 public:
  /// `advice` may be null.
  Task(const Context& context, SimulateRequest&& asked, std::unique_ptr<const Advice> advice, double seconds)
      : context_(context),
        request_(std::move(asked.run)),
        sensitivities_(std::move(asked.sensitivities)),
        advice_(std::move(advice)),
        seconds_(seconds) {
    if (advice_)
      choice_.emplace(AdviceWithCards{*advice_, context.cards.schemes, asked.wish && !std::isnan(asked.wish->seconds)});
  }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  const Context& context() const { return context_; }
  PlannedRun planned() const {
    return {request_, request_.scene->card(), context_.cards.schemes[request_.scheme], choice_ ? &*choice_ : nullptr,
            sensitivities_.get()};
  }
  Ended run(RowSink& sink, const std::atomic<bool>& cancelled) const {
    Request request = request_;
    request.limits.seconds = seconds_;
    const Scene& scene = *request_.scene;
    TurnedRows turned(request_, sink);
    RowSink& receiver = goes_backward(scene) ? turned : sink;
    Ended ended;
    Solution& outcome = ended.outcome;
    if (sensitivities_) {
      variations::VariedRun run(std::move(request), sensitivities_);
      outcome = run.go(receiver, cancelled);
      ended.sensitivities = run.sensitivities(outcome, cancelled);
      constexpr double worthless = 0.1;  // relative uncertainty from which derivatives are worthless
      if (const double doubt = ended.sensitivities->uncertainty; doubt > worthless)
        outcome.warnings.push_back({"uncertain_sensitivities", messages::uncertain_sensitivities(doubt)});
    } else {
      outcome = scene.mechanics->run(request, receiver, cancelled);
    }
    if (advice_ && advice_->before_act) {
      const auto& [event, t] = *advice_->before_act;
      outcome.warnings.push_back({"judged_before_acts", messages::judged_before_acts(event, t)});
    }
    turn(scene, outcome);
    constexpr std::string_view code = "reference_not_finished";
    if (advice_ && !advice_->referenced &&
        std::ranges::find(outcome.warnings, code, &Warning::code) == outcome.warnings.end())
      outcome.warnings.push_back(
          {code, "the error of the scheme chosen was not measured against a reference solution"});
    if (outcome.stop.reason == ReturnCode::deadline) outcome.stop.detail = messages::deadline(request_.limits.seconds);
    return ended;
  }

 private:
  const Context& context_;
  const Request request_;
  const std::shared_ptr<const variations::SensitivitiesAsked> sensitivities_;
  const std::unique_ptr<const Advice> advice_;
  std::optional<AdviceWithCards> choice_;
  const double seconds_;
};
using SharedTask = std::shared_ptr<const Task>;

void note_run(Answer& answer, const PlannedRun& run, const Solution& outcome) {
  answer.note("run", std::string(name(outcome.stop.reason)));
  answer.note("problem", run.problem.id);
  answer.note("scheme", run.scheme.id);
  answer.note("steps", outcome.cost.steps);
  answer.note("seconds", outcome.cost.seconds);
}

FinishedRun finished(const Task& task, const Ended& ended, const KeptRun& rows) {
  return {task.planned(), ended.outcome, rows.samples, task.planned().request.section ? &rows.points : nullptr,
          ended.slopes()};
}

// The answer when the run is over. Of a large one only the numbers are kept; it is written while it is sent.
Answer answer_whole(const SharedTask& task, const HttpRequest& question, const Form& form) {
  constexpr std::size_t large = 32 * 1024;  // numbers, about 20 bytes each as text
  auto rows = std::make_shared<KeptRun>(task->planned().request, &task->context().memory);
  Ended ended;
  {
    const CancellationWatch watch(task->context().cancelled, question.gone);
    ended = task->run(*rows, watch.cancelled());
  }
  if (rows->overflowed()) {
    const bool by_points = rows->points.overflowed();
    const std::size_t held = rows->bytes();
    return no_room(task->context(), question, by_points ? "/section" : "/record",
                   by_points ? "the points of the section" : "the samples", held, held + KeptRows::bytes_of_block);
  }
  const FinishedRun run = finished(*task, ended, *rows);
  Answer answer;
  const auto numbers = [](const KeptRows& kept) { return kept.rows() * kept.columns(); };
  if (numbers(rows->samples) + numbers(rows->points) + ended.numbers_of_slopes() <= large) {
    answer = whole_answer(form, run);
    note_run(answer, run, ended.outcome);
    return answer;
  }
  answer.type = form.content_type;
  if (form.add_fields) form.add_fields(run, answer);
  note_run(answer, run, ended.outcome);
  const auto kept = std::make_shared<const Ended>(std::move(ended));
  const auto whole = std::make_shared<const FinishedRun>(finished(*task, *kept, *rows));
  answer.pieces = [task, rows = std::move(rows), kept, whole, &form, next = std::size_t{0}](std::string& out) mutable {
    form.write(*whole, next, out);
    return ++next < form.pieces(*whole);
  };
  return answer;
}

// Lines are sent as the run goes on. Nothing is kept, and a client that takes no more ends the run.
class Lines final : public RowSink {
 public:
  Lines(const PlannedRun& run, const Write& write) : run_(run), write_(write) {}

  bool append(std::span<const double> rows) override { return write_(run_samples_line(run_, rows)); }
  bool append_section(std::span<const double> rows) override {
    const std::int64_t before = points_;
    points_ += std::ssize(rows) / std::ssize(run_.request.section_columns());
    return write_(run_points_line(run_, rows, before));
  }
  bool progress(double t, std::int64_t steps) override { return write_(run_progress_line(t, steps)); }

 private:
  const PlannedRun& run_;
  const Write& write_;
  std::int64_t points_ = 0;  ///< points sent so far
};

Answer answer_in_lines(const SharedTask& task, const HttpRequest& question, Admission::Pass&& pass) {
  Answer answer;
  answer.type = in_lines;
  answer.begins = "{";
  const auto held = std::make_shared<std::optional<Admission::Pass>>(std::move(pass));
  answer.notes = std::make_shared<std::vector<Note>>();
  answer.stream = [task, held, gone = question.gone,
                   notes = answer.notes](const Write& write) -> std::optional<std::string> {
    const PlannedRun planned = task->planned();
    if (!write(run_head_line(planned))) return std::nullopt;
    Lines lines(planned, write);
    const CancellationWatch watch(task->context().cancelled, gone);
    Ended ended;
    try {
      ended = task->run(lines, watch.cancelled());
    } catch (const MemoryShortage& shortage) {  // the rows so far have been sent as lines
      ended = {};
      ended.outcome.stop = {ReturnCode::memory, shortage.what(), forward_of(*planned.request.scene).start, 0, {}};
    }
    ended.hold_text_of_slopes();
    Answer told;
    note_run(told, planned, ended.outcome);
    *notes = std::move(*told.notes);
    held->reset();  // the place is free before the client can have read the end
    return run_end_line(planned, ended.outcome, ended.slopes());
  };
  return answer;
}

// no_choice answers a wish for which no scheme could be chosen.
Answer no_choice(const Context& context, const HttpRequest& request, const SimulateRequest& asked, const Advice& advice,
                 ReturnCode end) {
  Faults faults;
  const FieldPath top{"", &faults};
  if (end == ReturnCode::cancelled) return busy(context, request, "the service ends");
  if (end == ReturnCode::deadline) {
    const auto sent = parse_json(request.body, {}, &context.memory);
    const Json::json_pointer seconds("/limits/seconds");
    if (sent && sent->tree.contains(seconds)) {
      top.at("limits").at("seconds").fault("is too short to choose a scheme in", Json(asked.run.limits.seconds));
    } else {
      top.at("scheme").lacks(
          fmt::format("no scheme could be chosen within the {} s that a request has by default; "
                      "`limits`: {{\"seconds\": …}} gives it more",
                      asked.run.limits.seconds));
    }
  } else {
    top.at("scheme").lacks(advice.reason.text());
  }
  return problem_document(faults, request.id);
}

// faults_of_choice returns the faults of a run whose scheme was chosen, as if its echo had been sent: a step that no
// request may have, where the motion cannot be followed, or too many samples.
std::optional<Faults> faults_of_choice(const Task& task) {
  std::string echo;
  JsonWriter json(echo);
  json.open('{');
  write_echo(json, task.planned());
  json.close('}');
  auto again = decode(std::move(*parse_json(echo)), task.context().cards, task.context().caps,
                      forward_of(*task.planned().request.scene).mechanics);
  if (again) return std::nullopt;
  if (!again.error().within("/scheme")) return again.error();
  Faults faults;
  FieldPath{"/scheme", &faults}.lacks("no scheme was found that follows this motion to its end; of those measured, " +
                                      task.planned().choice->advice.reason.text());
  return faults;
}

// choose returns the run with the scheme that grants its wish, or why there is none. Choosing and running share the
// time limit.
Result<SharedTask, Answer> choose(const Context& context, const HttpRequest& request, SimulateRequest& asked) {
  const auto from = Admission::Clock::now();
  const double limit = asked.run.limits.seconds;
  Advice advice;
  ReturnCode end;
  {
    constexpr double margin = 0.05;  // the core itself takes at most half; what it cannot interrupt is cut off
    const CancellationWatch watch(context.cancelled, request.gone, limit / 2 + margin);
    advice = advise(asked.run, *asked.wish, watch.cancelled());
    if (goes_backward(*asked.run.scene)) advice.reason.turn_times();
    end = end_of(watch);
  }
  if (!advice.choice) return no_choice(context, request, asked, advice, end);
  asked.run.scheme = advice.choice->scheme;
  asked.run.settings = advice.choice->settings;
  const std::chrono::duration<double> spent = Admission::Clock::now() - from;
  const double left = std::max(limit - spent.count(), 0.0);
  auto task =
      std::make_shared<const Task>(context, std::move(asked), std::make_unique<const Advice>(std::move(advice)), left);
  if (auto faults = faults_of_choice(*task)) return problem_document(*faults, request.id);
  return SharedTask(std::move(task));
}

Answer compute(const Context& context, const HttpRequest& request, std::size_t form, SimulateRequest& asked,
               Admission::Pass&& pass) {
  pass.may_take(asked.run.limits.seconds);
  SharedTask task;
  if (asked.wish) {
    auto chosen = choose(context, request, asked);
    if (!chosen) return chosen.error();
    task = std::move(*chosen);
  } else {
    const double seconds = asked.run.limits.seconds;
    task = std::make_shared<const Task>(context, std::move(asked), nullptr, seconds);
  }
  return form < forms().size() ? answer_whole(task, request, forms()[form])
                               : answer_in_lines(task, request, std::move(pass));
}

}  // namespace

Prepared simulate(const Context& context, const HttpRequest& request) {
  static const Names types = [] {
    Names all;
    for (const Form& form : forms()) all.push_back(form.type);
    all.push_back(in_lines);
    return all;
  }();
  auto form = form_for(request, types);
  if (!form) return form.error();
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  auto asked = decode(std::move(*parsed), context.cards, context.caps);
  if (!asked) return problem_document(asked.error(), request.id);
  return Job([&context, request, form = *form, asked = std::make_shared<SimulateRequest>(std::move(*asked))](
                 Admission::Pass pass) { return compute(context, request, form, *asked, std::move(pass)); });
}

}  // namespace least::server
