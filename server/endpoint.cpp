#include "server/endpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/catalogue/catalogue.hpp"
#include "server/decode/custom_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/accept.hpp"
#include "server/http/outbox.hpp"
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

Answer no_room(const Context& context, const HttpRequest& request, std::string_view pointer, std::string_view what,
               std::size_t own, std::size_t need) {
  // What this request is charged besides: its body, read as JSON, and its answer on the way.
  constexpr std::size_t little = (std::size_t{1} << 20) + most_of_a_stream;
  const std::size_t most = context.memory.most(), held = context.memory.held();
  if (need <= most && held > own + little)
    return busy(context, request, fmt::format("other requests hold the memory that {} need: ask again later", what));
  Faults faults;
  faults.add(
      {std::string(pointer),
       fmt::format("{} need {} bytes of memory or more, and all requests together have {}: ask for fewer columns, "
                   "rows or points, or for a lower limits.samples",
                   what, need, most),
       {},
       fmt::format("what needs less than {} bytes; --max-memory allows more", most)});
  return problem_document(faults, request.id);
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
