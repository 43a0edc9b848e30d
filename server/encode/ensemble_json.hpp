// Ensembles as bytes, and blocks of members as lines of text.
#pragma once

#include <string>

#include "core/ensemble/ensemble.hpp"
#include "server/encode/text_pieces.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// EnsembleEnd is how an ensemble ended, how long it took, and the warnings of some of its members.
struct EnsembleEnd {
  ReturnCode reason = ReturnCode::completed;
  double seconds = 0;  ///< NaN where it is not known
  std::vector<Warning> warnings{};
};

/// The whole answer as `application/json` or `application/cbor` (RFC 8949): the same members; in CBOR the columns of
/// finals and sections are typed arrays (RFC 8746) of little-endian binary64, with NaN where there is no value.
TextPieces pieces_of_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                              Notation notation);
std::string encode_ensemble(const EnsemblePlan& plan, const Cards& cards, const Harvest& all, const EnsembleEnd& end,
                            Notation notation = Notation::json);

/// `application/x-ndjson`: the first line (the echo), a line per block, and the last line (the totals).
std::string encode_ensemble_head(const EnsemblePlan& plan, const Cards& cards);
TextPieces pieces_of_block(const EnsemblePlan& plan, const Block& block);
std::string encode_ensemble_end(const EnsemblePlan& plan, const Harvest& all, const EnsembleEnd& end);

}  // namespace least::server
