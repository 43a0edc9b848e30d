#include "server/endpoint.hpp"

#include <fmt/format.h>

#include "core/catalogue.hpp"
#include "server/accept.hpp"
#include "server/problem_document.hpp"

namespace least::server {

Result<std::size_t, Answer> form_for(const Question& question, const Names& types) {
  if (const auto form = negotiate(question.accept, types)) return *form;
  return problem_document(406, "the answer comes as " + listed(types), question.id);
}

Result<ParsedJson, Answer> json_of(const Question& question) {
  auto parsed = parse_json(question.body);
  if (parsed) return std::move(*parsed);
  const NotJson& why = parsed.error();
  return problem_document(400, fmt::format("not JSON at byte {}: {}", why.byte, why.detail), question.id);
}

std::optional<Gate::Pass> turn(const Context& context) {
  // Longer than most runs, shorter than what clients and proxies wait for an answer.
  constexpr std::chrono::seconds patience{10};
  return context.gate.enter(patience);
}

Answer busy(const Question& question) {
  Answer answer = problem_document(503, "as many runs as are allowed are computing or waiting", question.id);
  answer.headers.emplace_back("Retry-After", "1");
  return answer;
}

Cards catalogue_cards() { return {problem_cards(), schemes()}; }

}  // namespace least::server
