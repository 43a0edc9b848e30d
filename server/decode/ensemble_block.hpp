// Blocks of members from the lines of a part.
#pragma once

#include <optional>

#include "core/ensemble/ensemble.hpp"
#include "server/decode/json_parse.hpp"

namespace least::server {

/// A block from its line; nothing where it is not one of such a plan.
std::optional<Block> read_ensemble_block(const EnsemblePlan& plan, const Json& line);

}  // namespace least::server
