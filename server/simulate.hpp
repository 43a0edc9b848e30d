// One run from the text of a request to its answer; HTTP and the command line share it.
#pragma once

#include <span>
#include <string_view>

#include "server/encode/run_answer.hpp"
#include "server/endpoint.hpp"

namespace least::server {

/// A form of the answer. A further one is a further entry of `forms`.
struct Form {
  std::string_view type;  ///< media type
  Answer (*encode)(const FinishedRun&);
};

/// All forms, the default first.
std::span<const Form> forms();

/// POST /v1/simulate.
Answer simulate(const Context& context, const HttpRequest& request);

}  // namespace least::server
