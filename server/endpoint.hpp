// What the endpoints that compute have in common.
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

/// What requests share.
struct Context {
  Cards cards;
  Caps caps;
  Admission& admission;
  const std::atomic<bool>& cancelled;  ///< the service ends
  MemoryBudget& memory;                ///< for what answers keep
};

/// A refusal (400: no JSON, 406, 422), or the work, which answers 200, 422 or 503. Both throw when memory is out or the
/// core has a bug. Context and request outlive the work.
using Endpoint = Prepared (*)(const Context&, const HttpRequest&);

/// Does the work at once; 503 where there is no place for it.
Answer answer_now(Endpoint endpoint, const Context& context, const HttpRequest& request);

/// The position of the form that the client likes best, or 406.
Result<std::size_t, Answer> form_for(const HttpRequest& request, const Names& types);

/// What it takes to read a body, from a glance at it. `brief`: it is no JSON whatever follows, which `json_of` sees
/// without reading on.
Effort effort_of(std::string_view body);

/// The body as JSON, or 400; 503 where there is no memory for its tree.
Result<ParsedJson, Answer> json_of(const Context& context, const HttpRequest& request);

/// 503, with the time after which it is worth to ask again.
Answer busy(const Context& context, const HttpRequest& request, std::string_view why);

/// Why a watched computation ended: `deadline`, `cancelled`, or `completed` where it was left alone.
ReturnCode end_of(const CancellationWatch& watch);

/// The catalogue of the library.
Cards catalogue_cards();

}  // namespace least::server
