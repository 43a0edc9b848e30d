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
#include "server/http/http_request.hpp"
#include "server/shared/answer.hpp"
#include "server/shared/kept_rows.hpp"

namespace least::server {

/// What requests share.
struct Context {
  Cards cards;
  Caps caps;
  Admission& admission;
  const std::atomic<bool>& cancelled;  ///< the service ends
  MemoryBudget& memory;                ///< for the samples of answers
};

/// 200, 400 (no JSON), 406, 422 or 503. Throws when memory is out or the core has a bug.
using Endpoint = Answer (*)(const Context&, const HttpRequest&);

/// The position of the form that the client likes best, or 406.
Result<std::size_t, Answer> form_for(const HttpRequest& request, const Names& types);

/// The body as JSON, or 400.
Result<ParsedJson, Answer> json_of(const HttpRequest& request);

/// A turn to compute, or nothing: then the answer is `busy`.
std::optional<Admission::Pass> admit(const Context& context, const HttpRequest& request);
Answer busy(const Context& context, const HttpRequest& request,
            std::string_view why = "as many runs as are allowed are computing or waiting");

/// Why a watched computation ended: `deadline`, `cancelled`, or `completed` where it was left alone.
ReturnCode end_of(const CancellationWatch& watch);

/// The catalogue of the library.
Cards catalogue_cards();

}  // namespace least::server
