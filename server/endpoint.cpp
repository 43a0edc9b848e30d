#include "server/endpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/custom_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/accept.hpp"
#include "server/http/request_reader.hpp"

namespace least::server {
namespace {

constexpr std::size_t glance = 4096;  // bytes of a body that effort_of reads

// no_json_begins tells whether a body begins in a way that JSON cannot, so that the rest need not be read.
bool no_json_begins(std::string_view body) {
  constexpr std::string_view blank = " \t\r\n", byte_order = "\xEF\xBB\xBF", values = "{[\"-0123456789tfn";
  const std::size_t first = body.substr(0, glance).find_first_not_of(blank);
  return first != body.npos && values.find(body[first]) == values.npos && !body.starts_with(byte_order);
}

}  // namespace

Result<std::size_t, Answer> form_for(const HttpRequest& request, const Names& types) {
  if (const auto form = negotiate(request.accept, types)) return *form;
  return problem_document(406, "the answer comes as " + listed(types), request.id);
}

Effort effort_of(std::string_view body) {
  if (no_json_begins(body)) return Effort::brief;
  // A scene given as text, whose equations have to be derived
  const bool has_text = body.size() <= glance && body.find(custom_id) != body.npos;
  return has_text ? Effort::work : Effort::reading;
}

Result<ParsedJson, Answer> json_of(const Context& context, const HttpRequest& request) {
  const std::string_view body = request.body;
  auto parsed = parse_json(no_json_begins(body) ? body.substr(0, glance) : body, {}, &context.memory);
  if (parsed) return std::move(*parsed);
  const NotJson& why = parsed.error();
  if (why.no_memory) return busy(context, request, full_memory(context.memory));
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

Cards catalogue_cards() {
  static const std::vector<std::shared_ptr<const Mechanics>> problems = [] {
    std::vector<std::shared_ptr<const Mechanics>> all(problem_list().begin(), problem_list().end());
    std::ranges::transform(text_problems(), std::back_inserter(all), &TextProblem::mechanics);
    std::ranges::sort(all, {}, [](const auto& problem) { return problem->card().id; });
    return all;
  }();
  return {problems, schemes()};
}

}  // namespace least::server
