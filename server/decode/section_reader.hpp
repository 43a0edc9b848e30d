// The section of an ensemble's request.
#pragma once

#include "core/ensemble/ensemble.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// Into `plan`, where sections are kept; in every case what stands there is checked. `scheme` may be null.
void read_section(const Json& root, const FieldPath& top, const ProblemCard& problem, const SchemeCard* scheme,
                  EnsemblePlan& plan);

}  // namespace least::server
