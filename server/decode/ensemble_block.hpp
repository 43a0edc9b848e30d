// Reads blocks of members from the lines of a part file.
#pragma once

#include <optional>

#include "core/ensemble/ensemble.hpp"
#include "server/decode/json_parse.hpp"

namespace least::server {

/// read_ensemble_block returns the block of a line; nothing where the line is no block of this plan.
std::optional<Block> read_ensemble_block(const EnsemblePlan& plan, const Json& line);

}  // namespace least::server
