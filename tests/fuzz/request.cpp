#include <algorithm>
#include <string>

#include "server/decode/ensemble_request.hpp"
#include "server/decode/simulate_request.hpp"
#include "server/decode/study_request.hpp"
#include "server/encode/problem_document.hpp"
#include "server/encode/run_answer.hpp"
#include "server/endpoint.hpp"
#include "tests/fuzz/targets.hpp"

namespace least::fuzz {
namespace {

using namespace least::server;

void check(const Faults& faults, std::string_view bytes) {
  ensure(!faults.empty() && faults.list().size() <= Faults::most, "a refusal with no fault or too many");
  for (const Fault& fault : faults.list()) {
    ensure(fault.pointer.empty() || fault.pointer.front() == '/', "a place that is no pointer");
    ensure(!fault.detail.empty(), "a fault without a word");
    ensure(fault.position.value_or(0) <= bytes.size(), "a fault beyond the end");
  }
  const Json document = Json::parse(problem_document(faults, "id").body);
  ensure(document["errors"].size() == faults.list().size(), "a fault that is not told");
}

std::string echo_of(const SimulateRequest& request, const Cards& cards) {
  return run_head_line({request.run, request.run.scene->card(), cards.schemes[request.run.scheme]});
}

void check(std::string_view bytes) {
  static const Cards cards = catalogue_cards();
  const auto parsed = parse_json(bytes);
  if (!parsed) {
    ensure(parsed.error().byte <= bytes.size(), "no JSON beyond the end");
    const Json document = Json::parse(problem_document(400, parsed.error().detail, "id").body);
    return ensure(document["status"] == 400, "a refusal that is none");
  }
  const auto copy = [&] { return ParsedJson{parsed->tree, parsed->faults}; };
  if (const auto plan = decode_work_precision(copy(), cards, {}); !plan) check(plan.error(), bytes);
  if (const auto plan = decode_stability(copy(), cards, {}); !plan) check(plan.error(), bytes);
  if (const auto plan = decode_ensemble(copy(), cards, {}); !plan) check(plan.error(), bytes);
  const auto read = decode(copy(), cards, {});
  if (!read) return check(read.error(), bytes);
  if (read->wish) return;  // its scheme is still to be chosen
  const std::string first = echo_of(*read, cards);
  Json echo = Json::parse(first);
  echo.erase("kind");
  echo.erase("version");
  const auto again = decode({std::move(echo), {}}, cards, {});
  ensure(static_cast<bool>(again), "its echo is no request");
  ensure(echo_of(*again, cards) == first, "its echo is another request");
}

}  // namespace

void request(std::string_view bytes) {
  try {
    check(bytes);
  } catch (const std::runtime_error& e) {
    // A build with few forms says so where another one is needed.
    if (!std::string_view(e.what()).starts_with("this build leaves out")) throw;
  }
}

}  // namespace least::fuzz
