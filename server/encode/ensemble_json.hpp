// Ensembles → bytes, and blocks of members to lines of text.
#pragma once

#include <string>

#include "core/ensemble/ensemble.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// Where an ensemble ended, and how long it took.
struct EnsembleEnd {
  ReturnCode reason = ReturnCode::completed;
  double seconds = 0;
};

/// `application/json`: the whole answer.
std::string encode_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end);

/// `application/x-ndjson`: the first line (the echo), one per block, and the last (what they add up to). Points of
/// sections beyond the first `most` are left out.
std::string encode_ensemble_head(const EnsemblePlan& plan, const Cards& cards);
std::string encode_ensemble_block(const EnsemblePlan& plan, const Block& block);
std::string encode_ensemble_end(const EnsemblePlan& plan, const Harvest& all, const EnsembleEnd& end);

}  // namespace least::server
