#include "server/simulate.hpp"

#include "core/catalogue.hpp"
#include "server/decode/field_reader.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

Answer run_and_encode(const Context& context, const Form& form, const Request& request, const Choosing* choosing) {
  Samples samples;
  const Outcome outcome = run(request, samples, context.cancelled);
  const Cards& cards = context.cards;
  return form.encode(
      {request, cards.problems[request.problem], cards.schemes[request.scheme], outcome, samples, choosing});
}

// Why there is nothing to run.
Answer no_choice(const Question& question, const Order& order, const Advice& advice, Reason end) {
  Faults faults;
  const Place top{"", &faults};
  if (end == Reason::cancelled) return busy(question);
  if (end == Reason::deadline) {
    top.at("limits").at("seconds").fault("is too short to choose a scheme in", Json(order.run.limits.seconds));
  } else {
    top.at("scheme").lacks(advice.reason);
  }
  return problem_document(faults, question.id);
}

Answer choose_and_run(const Context& context, const Question& question, const Form& form, Order& order) {
  Advice advice;
  Reason end;
  {
    constexpr double margin = 1;  // the core keeps the limit itself; what it cannot interrupt is cut off
    const Watch watch(context.cancelled, question.gone, order.run.limits.seconds + margin);
    advice = advise(order.run, *order.wish, watch.cancelled());
    end = watch.reason();
  }
  if (!advice.choice) return no_choice(question, order, advice, end);
  order.run.scheme = advice.choice->scheme;
  order.run.settings = advice.choice->settings;
  const Choosing choosing{advice, context.cards.schemes};
  return run_and_encode(context, form, order.run, &choosing);
}

}  // namespace

std::span<const Form> forms() {
  static constexpr Form all[] = {{"application/json", encode_json}, {"text/csv", encode_csv}};
  return all;
}

Answer simulate(const Context& context, const Question& question) {
  Names types;
  for (const Form& form : forms()) types.push_back(form.type);
  auto form = form_for(question, types);
  if (!form) return form.error();
  auto parsed = json_of(question);
  if (!parsed) return parsed.error();
  auto order = decode(std::move(*parsed), context.cards, context.caps);
  if (!order) return problem_document(order.error(), question.id);
  const auto pass = turn(context);
  if (!pass) return busy(question);
  if (order->wish) return choose_and_run(context, question, forms()[*form], *order);
  return run_and_encode(context, forms()[*form], order->run, nullptr);
}

}  // namespace least::server
