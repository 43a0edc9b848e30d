// Solution of a run → bytes. Written straight from the samples, no tree in between.
#pragma once

#include <string>
#include <string_view>

#include "core/run/outcome.hpp"
#include "core/run/request.hpp"
#include "core/study/study.hpp"
#include "server/shared/answer.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// How the scheme of a run was chosen, with the cards of all schemes.
struct AdviceWithCards {
  const Advice& advice;
  std::span<const SchemeCard> schemes;
};

/// A run that is over: everything an encoder reads.
struct FinishedRun {
  const Request& request;
  const ProblemCard& problem;
  const SchemeCard& scheme;
  const Solution& outcome;
  const Samples& samples;
  const AdviceWithCards* choice = nullptr;  ///< where it was not the client who chose
};

/// `application/json`: the response of the contract.
Answer encode_json(const FinishedRun& run);

/// `text/csv`: a line of column names, then a line per sample; what has no value is empty. The rest stands
/// as one-line JSON in header fields `Leastaction-Status`, `-Stop`, `-Request` (the echo), `-SchemeConfig`, `-Final`,
/// `-Diagnostics`,
/// `-Events`, `-Cost` and `-Warnings`; one that would be longer than 4 KiB says `{"omitted":true}`.
Answer encode_csv(const FinishedRun& run);

}  // namespace least::server
