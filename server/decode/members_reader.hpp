// Reads the members of an ensemble, and what varies among them.
#pragma once

#include <vector>

#include "server/decode/ensemble_request.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// read_list returns a list of numbers within a range; it is shorter where some entries are faulty.
std::vector<double> read_list(const Json& json, const FieldPath& path, const Range& range);

/// read_members reads the number of members, their seed and what varies. `scene` is null where the problem could not be
/// read.
void read_members(const Json& root, const FieldPath& top, const Scene* scene, EnsemblePlan& plan);

}  // namespace least::server
