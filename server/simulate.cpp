#include "server/simulate.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/catalogue.hpp"
#include "server/accept.hpp"
#include "server/problem_document.hpp"
#include "server/wording.hpp"

namespace least::server {
namespace {

// Longer than most runs, shorter than what clients and proxies wait for an answer.
constexpr std::chrono::seconds patience{10};

}  // namespace

std::span<const Form> forms() {
  static constexpr Form all[] = {{"application/json", encode_json}, {"text/csv", encode_csv}};
  return all;
}

Answer Simulator::operator()(std::string_view body, std::string_view accept, std::string_view request_id) const {
  Names types;
  for (const Form& form : forms()) types.push_back(form.type);
  const auto form = negotiate(accept, types);
  if (!form) return problem_document(406, "the answer comes as " + listed(types), request_id);

  auto parsed = parse_json(body);
  if (!parsed) {
    const NotJson& why = parsed.error();
    return problem_document(400, fmt::format("not JSON at byte {}: {}", why.byte, why.detail), request_id);
  }
  const auto request = decode(std::move(*parsed), cards, caps);
  if (!request) return problem_document(request.error(), request_id);

  const auto pass = gate.enter(patience);
  if (!pass) {
    Answer busy = problem_document(503, "as many runs as are allowed are computing or waiting", request_id);
    busy.headers.emplace_back("Retry-After", "1");
    return busy;
  }
  Samples samples;
  const Outcome outcome = run(*request, samples, cancelled);
  return forms()[*form].encode(
      {*request, cards.problems[request->problem], cards.schemes[request->scheme], outcome, samples});
}

Cards catalogue_cards() { return {problems(), schemes()}; }

}  // namespace least::server
