// Studies → bytes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/status.hpp"
#include "core/study/study.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// What was asked for, and the cards that name things.
struct PlanWithCards {
  const StudyPlan& plan;
  Cards cards;
};

/// `application/json`: the whole answer. `end` is other than completed where it was cut short.
std::string encode_study(const PlanWithCards& planned, const least::Study& study, ReturnCode end);

/// `application/x-ndjson`: the first line (the echo, the reference and what it can say), one per point (the newest of a
/// curve), and the last (the rest).
std::string encode_study_head(const PlanWithCards& planned, const least::Study& study);
std::string encode_study_point(const PlanWithCards& planned, std::size_t index, const StudyCurve& curve);
std::string encode_study_end(const PlanWithCards& planned, const least::Study& study, ReturnCode end);

/// The limits that were found, of the first schemes that were asked for.
struct StabilityFindings {
  const Request& scene;
  const std::vector<SchemeConfig>& schemes;
  const std::vector<StabilityLimit>& limits;
  Cards cards;
};

/// `application/json`: the limits, and the schemes that no time was left for.
std::string encode_stability(const StabilityFindings& findings, ReturnCode end);

}  // namespace least::server
