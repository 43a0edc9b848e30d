#include "server/periodic.hpp"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "server/decode/field_reader.hpp"
#include "server/decode/periodic_request.hpp"
#include "server/encode/periodic_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/cancellation.hpp"

namespace least::server {
namespace {

using Shared = std::shared_ptr<const periodic::Question>;
using SharedMotions = std::shared_ptr<const periodic::Motions>;

void note_orbit(Answer& answer, const periodic::Question& question, const periodic::Answer& found) {
  answer.note("orbit", std::string(found.closed ? "closed" : "not_closed"));
  answer.note("problem", question.scene->card().id);
  answer.note("steps", found.steps);
  answer.note("seconds", found.seconds);
}

Answer closed_as_a_whole(const Context& context, const HttpRequest& request, const Shared& question,
                         const SharedMotions& motions) {
  auto found = std::make_shared<periodic::Answer>();
  {
    const CancellationWatch watch(context.cancelled, request.gone);
    *found = periodic::close_orbit(*question, *motions, watch.cancelled());
  }
  Answer answer;
  answer.type = "application/json";
  note_orbit(answer, *question, *found);
  // The curves of manifolds are written one by one while the answer is sent.
  answer.pieces = [question, found, next = std::size_t{0}](std::string& out) mutable {
    return encode_orbit(*question, *found, next++, out);
  };
  return answer;
}

// Keeps only what the last line needs: each member is sent as it is found, and a client that takes no more ends the
// search.
Answer closed_in_lines(const Context& context, const HttpRequest& request, const Shared& question,
                       const SharedMotions& motions, Admission::Pass&& pass) {
  Answer answer{200, "application/x-ndjson", {}, {}};
  answer.begins = "{";
  answer.notes = std::make_shared<std::vector<Note>>();
  const auto held = std::make_shared<std::optional<Admission::Pass>>(std::move(pass));
  answer.stream = [&context, question, motions, held, gone = request.gone,
                   notes = answer.notes](const Write& write) -> std::optional<std::string> {
    if (!write(orbit_head_line(*question))) return std::nullopt;
    periodic::Answer found;
    try {
      const CancellationWatch watch(context.cancelled, gone);
      found = periodic::close_orbit(*question, *motions, watch.cancelled(),
                                    [&](const periodic::Member& member) { return write(orbit_member_line(member)); });
    } catch (const MemoryShortage& shortage) {
      found = {};
      found.orbit.scene = question->scene;
      found.reason = shortage.what();
      found.end = ReturnCode::memory;
    }
    Answer told;
    note_orbit(told, *question, found);
    *notes = std::move(*told.notes);
    held->reset();  // the place is free before the client can have read the end
    return orbit_end_line(*question, found);
  };
  return answer;
}

Answer closed(const Context& context, const HttpRequest& request, bool lines, const Shared& question,
              Admission::Pass&& pass) {
  auto made = periodic::motions_of(*question);
  if (const auto* wrong = std::get_if<periodic::Objection>(&made)) {
    Faults faults;
    FieldPath{wrong->pointer, &faults}.lacks(wrong->detail, wrong->allowed);
    return problem_document(faults, request.id);
  }
  const auto motions = std::make_shared<const periodic::Motions>(std::get<periodic::Motions>(std::move(made)));
  return lines ? closed_in_lines(context, request, question, motions, std::move(pass))
               : closed_as_a_whole(context, request, question, motions);
}

}  // namespace

Prepared close_orbit_request(const Context& context, const HttpRequest& request) {
  auto form = form_for(request, {"application/json", "application/x-ndjson"});
  if (!form) return form.error();
  auto parsed = json_of(context, request);
  if (!parsed) return parsed.error();
  auto question = decode_periodic(std::move(*parsed), context.cards, context.caps);
  if (!question) return problem_document(question.error(), request.id);
  return Job([&context, request, lines = *form == 1,
              shared = std::make_shared<const periodic::Question>(std::move(*question))](Admission::Pass pass) {
    pass.may_take(shared->limits.seconds);
    return closed(context, request, lines, shared, std::move(pass));
  });
}

}  // namespace least::server
