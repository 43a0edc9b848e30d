#include "server/endpoint.hpp"

#include <fmt/format.h>

#include "core/catalogue/catalogue.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/accept.hpp"

namespace least::server {

Result<std::size_t, Answer> form_for(const HttpRequest& request, const Names& types) {
  if (const auto form = negotiate(request.accept, types)) return *form;
  return problem_document(406, "the answer comes as " + listed(types), request.id);
}

Result<ParsedJson, Answer> json_of(const HttpRequest& request) {
  auto parsed = parse_json(request.body);
  if (parsed) return std::move(*parsed);
  const NotJson& why = parsed.error();
  return problem_document(400, fmt::format("not JSON at byte {}: {}", why.byte, why.detail), request.id);
}

Answer answer_now(Endpoint endpoint, const Context& context, const HttpRequest& request) {
  Prepared prepared = endpoint(context, request);
  if (auto* const answer = std::get_if<Answer>(&prepared)) return std::move(*answer);
  auto pass = context.admission.enter(request.client);
  if (!pass) return busy(context, request, "as many runs as are allowed are computing");
  return std::get<Job>(prepared)(std::move(*pass));
}

Answer busy(const Context& context, const HttpRequest& request, std::string_view why) {
  Answer answer = problem_document(503, why, request.id);
  answer.headers.emplace_back("Retry-After", std::to_string(context.admission.retry_after()));
  return answer;
}

ReturnCode end_of(const CancellationWatch& watch) {
  if (!watch.cancelled()) return ReturnCode::completed;
  return watch.timed_out() ? ReturnCode::deadline : ReturnCode::cancelled;
}

Cards catalogue_cards() { return {problem_list(), schemes()}; }

}  // namespace least::server
