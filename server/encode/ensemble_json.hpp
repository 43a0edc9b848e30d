// Ensembles → bytes, and blocks of members to lines of text.
#pragma once

#include <string>

#include "core/ensemble/ensemble.hpp"
#include "server/encode/text_pieces.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// Where an ensemble ended, how long it took, and what some of its members say against themselves.
struct EnsembleEnd {
  ReturnCode reason = ReturnCode::completed;
  double seconds = 0;
  std::vector<Warning> warnings{};
};

/// The whole answer, `application/json` or `application/cbor` (RFC 8949): the members of JSON, the columns of finals
/// and sections as typed arrays (RFC 8746) of binary64 in little endian, in which what has no value is NaN.
TextPieces pieces_of_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                              Notation notation);
std::string encode_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                            Notation notation = Notation::json);

/// `application/x-ndjson`: the first line (the echo), one per block, and the last (what they add up to).
std::string encode_ensemble_head(const EnsemblePlan& plan, const Cards& cards);
TextPieces pieces_of_block(const EnsemblePlan& plan, const Block& block);
std::string encode_ensemble_end(const EnsemblePlan& plan, const Harvest& all, const EnsembleEnd& end);

}  // namespace least::server
