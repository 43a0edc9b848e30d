// What endpoints that compute have in common.
#pragma once

#include <atomic>
#include <optional>
#include <string_view>

#include "core/status.hpp"
#include "server/decode/simulate_request.hpp"
#include "server/decode/wording.hpp"
#include "server/http/admission.hpp"
#include "server/http/cancellation.hpp"
#include "server/http/effort.hpp"
#include "server/http/http_request.hpp"
#include "server/http/router.hpp"
#include "server/shared/answer.hpp"
#include "server/shared/kept_rows.hpp"

namespace least::server {

/// Context is what all requests share.
struct Context {
  Cards cards;
  Caps caps;
  Admission& admission;
  const std::atomic<bool>& cancelled;  ///< set when the service ends
  MemoryBudget& memory;                ///< for what answers keep in memory
};

/// An Endpoint reads a request and returns a refusal (400: no JSON, 406, 422), or the job, which answers 200, 422 or
/// 503. Both may throw when memory is short or the core has a bug. Context and request must outlive the job.
using Endpoint = Prepared (*)(const Context&, const HttpRequest&);

/// answer_now runs the job at once; 503 where there is no place for it.
Answer answer_now(Endpoint endpoint, const Context& context, const HttpRequest& request);

/// form_for returns the index of the media type that the client prefers, or a 406 answer.
Result<std::size_t, Answer> form_for(const HttpRequest& request, const Names& types);

/// effort_of estimates, from the beginning of a body, what reading it takes. `brief`: it cannot be JSON, which json_of
/// finds without reading on.
Effort effort_of(std::string_view body);

/// json_of returns the body as JSON, or 400; 503 where there is no memory for its tree.
Result<ParsedJson, Answer> json_of(const Context& context, const HttpRequest& request);

/// busy returns 503, with the time after which to try again.
Answer busy(const Context& context, const HttpRequest& request, std::string_view why);

/// no_room answers a request whose `what`, at a place of it, found no memory: 503 where other requests hold memory,
/// which they will give back; else 422, since asking again would not help. `own` is what the request still holds,
/// `need` what it needs at least, in bytes.
Answer no_room(const Context& context, const HttpRequest& request, std::string_view pointer, std::string_view what,
               std::size_t own, std::size_t need);

/// end_of returns why a watched computation ended: `deadline`, `cancelled`, or `completed` where it was not
/// interrupted.
ReturnCode end_of(const CancellationWatch& watch);

/// The catalogue of the library.
Cards catalogue_cards();

}  // namespace least::server
