// The members of an ensemble, and what varies among them.
#pragma once

#include <vector>

#include "server/decode/ensemble_request.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// A list of numbers within a range; fewer where some are none.
std::vector<double> read_list(const Json& json, const FieldPath& path, const Range& range);

/// How many members there are, their seed and what varies. `scene`: null where what it is of is not known.
void read_members(const Json& root, const FieldPath& top, const Scene* scene, EnsemblePlan& plan);

}  // namespace least::server
