// What the endpoints that compute have in common.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string_view>

#include "server/decode/simulate_request.hpp"
#include "server/decode/wording.hpp"
#include "server/http/admission.hpp"
#include "server/http/answer.hpp"

namespace least::server {

/// What requests share.
struct Context {
  Cards cards;
  Caps caps;
  Gate& gate;
  const std::atomic<bool>& cancelled;  ///< the service ends
};

/// What is asked. Of the texts only `id` is needed while an answer streams; all outlive it.
struct Question {
  std::string_view body, accept, id;
  std::function<bool()> gone{};  ///< whether the client still waits; empty: it always does
};

/// 200, 400 (no JSON), 406, 422 or 503. Throws when memory is out or the core has a bug.
using Endpoint = Answer (*)(const Context&, const Question&);

/// The position of the form that the client likes best, or 406.
Result<std::size_t, Answer> form_for(const Question& question, const Names& types);

/// The body as JSON, or 400.
Result<ParsedJson, Answer> json_of(const Question& question);

/// A turn to compute, or nothing: then the answer is `busy`.
std::optional<Gate::Pass> turn(const Context& context);
Answer busy(const Question& question);

/// The catalogue of the library.
Cards catalogue_cards();

}  // namespace least::server
