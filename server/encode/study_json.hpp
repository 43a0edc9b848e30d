// Studies as bytes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/status.hpp"
#include "core/study/study.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// PlanWithCards is what was asked for, with the cards that name problems and schemes.
struct PlanWithCards {
  const StudyPlan& plan;
  Cards cards;
};

/// `application/json`: the whole answer. `end` says why the study was cut short, if it was.
std::string encode_study(const PlanWithCards& planned, const least::Study& study, ReturnCode end);

/// `application/x-ndjson`: the first line (the echo, and what is known of the reference), a line per point (the newest
/// of its curve), and the last line (the rest).
std::string encode_study_head(const PlanWithCards& planned, const least::Study& study);
std::string encode_study_point(const PlanWithCards& planned, std::size_t index, const StudyCurve& curve);
std::string encode_study_end(const PlanWithCards& planned, const least::Study& study, ReturnCode end);

/// StabilityFindings are the limits found so far, in the order of the schemes that were asked for.
struct StabilityFindings {
  const Request& scene;
  const std::vector<SchemeConfig>& schemes;
  const std::vector<StabilityLimit>& limits;
  Cards cards;
};

/// `application/json`: the limits, and the schemes for which no time was left.
std::string encode_stability(const StabilityFindings& findings, ReturnCode end);

}  // namespace least::server
