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

std::optional<Admission::Pass> admit(const Context& context, const HttpRequest& request) {
  // Longer than most runs, shorter than what clients and proxies wait for an answer.
  constexpr std::chrono::seconds patience{10};
  const auto from = Admission::Clock::now();
  auto pass = context.admission.enter(request.client, patience, request.gone);
  const std::chrono::duration<double> waited = Admission::Clock::now() - from;
  if (request.seconds_queued) *request.seconds_queued += waited.count();
  return pass;
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
