// Errors as RFC 9457 problem documents.
#pragma once

#include <string_view>

#include "server/shared/answer.hpp"
#include "server/shared/fault.hpp"

namespace least::server {

/// problem_document returns an error answer; `detail` may be empty.
Answer problem_document(int status, std::string_view detail, std::string_view request_id);

/// The overload with faults returns 422 with every fault.
Answer problem_document(const Faults& faults, std::string_view request_id);

}  // namespace least::server
