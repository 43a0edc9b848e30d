#include "server/simulate.hpp"

#include "core/catalogue/catalogue.hpp"
#include "server/decode/field_reader.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

Answer run_and_encode(const Context& context, const HttpRequest& question, const Form& form, const Request& request,
                      const AdviceWithCards* choice) {
  Samples samples;
  const Mechanics& mechanics = *request.scene->mechanics;
  const CancellationWatch watch(context.cancelled, question.gone);
  const Solution outcome = mechanics.run(request, samples, watch.cancelled());
  return form.encode({request, mechanics.card(), context.cards.schemes[request.scheme], outcome, samples, choice});
}

// Why there is nothing to run.
Answer no_choice(const HttpRequest& request, const SimulateRequest& asked, const Advice& advice, ReturnCode end) {
  Faults faults;
  const FieldPath top{"", &faults};
  if (end == ReturnCode::cancelled) return busy(request);
  if (end == ReturnCode::deadline) {
    top.at("limits").at("seconds").fault("is too short to choose a scheme in", Json(asked.run.limits.seconds));
  } else {
    top.at("scheme").lacks(advice.reason);
  }
  return problem_document(faults, request.id);
}

Answer choose_and_run(const Context& context, const HttpRequest& request, const Form& form, SimulateRequest& asked) {
  Advice advice;
  ReturnCode end;
  {
    constexpr double margin = 1;  // the core keeps the limit itself; what it cannot interrupt is cut off
    const CancellationWatch watch(context.cancelled, request.gone, asked.run.limits.seconds + margin);
    advice = advise(asked.run, *asked.wish, watch.cancelled());
    end = end_of(watch);
  }
  if (!advice.choice) return no_choice(request, asked, advice, end);
  asked.run.scheme = advice.choice->scheme;
  asked.run.settings = advice.choice->settings;
  const AdviceWithCards choice{advice, context.cards.schemes};
  return run_and_encode(context, request, form, asked.run, &choice);
}

}  // namespace

std::span<const Form> forms() {
  static constexpr Form all[] = {{"application/json", encode_json}, {"text/csv", encode_csv}};
  return all;
}

Answer simulate(const Context& context, const HttpRequest& request) {
  Names types;
  for (const Form& form : forms()) types.push_back(form.type);
  auto form = form_for(request, types);
  if (!form) return form.error();
  auto parsed = json_of(request);
  if (!parsed) return parsed.error();
  auto asked = decode(std::move(*parsed), context.cards, context.caps);
  if (!asked) return problem_document(asked.error(), request.id);
  const auto pass = admit(context);
  if (!pass) return busy(request);
  if (asked->wish) return choose_and_run(context, request, forms()[*form], *asked);
  return run_and_encode(context, request, forms()[*form], asked->run, nullptr);
}

}  // namespace least::server
