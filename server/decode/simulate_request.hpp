// JSON → least::Request: strict, with every fault at once.
#pragma once

#include <cstdint>
#include <optional>

#include "core/run/request.hpp"
#include "core/study/study.hpp"
#include "core/variations/sensitivities.hpp"
#include "server/decode/json_parse.hpp"
#include "server/shared/cards.hpp"
#include "server/shared/fault.hpp"
#include "server/shared/result.hpp"

namespace least::server {

/// The most a client may ask for in `limits`.
struct Caps {
  double seconds = 60;
  std::int64_t steps = 10'000'000'000;
  std::int64_t samples = 10'000'000;
};

/// Samples a run keeps when the request does not say.
inline constexpr std::int64_t default_samples = 1000;

/// A run, or, where there is a wish, a run whose scheme and settings are still to be chosen.
struct SimulateRequest {
  Request run;
  std::optional<Wish> wish;
  std::shared_ptr<const variations::SensitivitiesAsked> sensitivities;  ///< null: not asked for
};

/// Reads a request of POST /v1/simulate. Every value of the result lies within its card's range and the pair fits; what
/// was left out has its default. Otherwise: all that is wrong. `known`: the problem, where it has been read before.
Result<SimulateRequest, Faults> decode(ParsedJson body, const Cards& cards, const Caps& caps,
                                       const std::shared_ptr<const Mechanics>& known = nullptr);

}  // namespace least::server
