// Studies → bytes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/status.hpp"
#include "server/decode/study_request.hpp"

namespace least::server {

/// What the encoders of a study read: the question and the cards that name things.
struct Asked {
  const StudyPlan& plan;
  Cards cards;
};

/// `application/json`: the whole answer. `end` is other than completed where it was cut short.
std::string encode_study(const Asked& asked, const least::Study& study, Reason end);

/// `application/x-ndjson`: the first line (the echo, the reference and what it can say), one per point (the newest of a
/// curve), and the last (the rest).
std::string encode_study_head(const Asked& asked, const least::Study& study);
std::string encode_study_point(const Asked& asked, std::size_t index, const StudyCurve& curve);
std::string encode_study_end(const Asked& asked, const least::Study& study, Reason end);

/// `application/json`: the limits that were found, and the schemes whose were not for want of time.
std::string encode_stability(const StabilityPlan& plan, const Cards& cards, const std::vector<StabilityLimit>& limits,
                             Reason end);

}  // namespace least::server
