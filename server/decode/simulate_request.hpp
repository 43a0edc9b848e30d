// JSON → least::Request: strict, and with all faults at once.
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

/// The number of samples a run keeps by default.
inline constexpr std::int64_t default_samples = 1000;

/// SimulateRequest is a run; with a wish, its scheme and settings are still to be chosen.
struct SimulateRequest {
  Request run;
  std::optional<Wish> wish;
  std::shared_ptr<const variations::SensitivitiesAsked> sensitivities;  ///< null: not asked for
};

/// decode reads a request of POST /v1/simulate. All values of the result are within the ranges of their cards, scheme
/// and problem go together, and omitted members have their defaults; otherwise it returns all faults. `known` is the
/// problem where it has been read before.
Result<SimulateRequest, Faults> decode(ParsedJson body, const Cards& cards, const Caps& caps,
                                       const std::shared_ptr<const Mechanics>& known = nullptr);

}  // namespace least::server
