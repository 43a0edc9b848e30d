// Parts of an ensemble that are computed separately, on machines of a cluster or one after the other, and merging them.
// A part is a text file: the echo of the request, the shard, a line per block of members, and the number of blocks. It
// is written under a temporary name, so that a part is complete or does not exist.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/endpoint.hpp"

namespace least::server {

/// write_part computes the shard `I/N` of the request and writes it; a complete part of the same request is kept.
/// Returns 200 with a line about what was done, or a problem document.
Answer write_part(const Context& context, const HttpRequest& request, const std::string& shard,
                  const std::string& output, unsigned threads);

/// merge_parts returns the answer that the whole ensemble would have had in one run, except for its cost; or what is
/// wrong with which parts.
Answer merge_parts(const Cards& cards, const std::vector<std::string>& paths, std::string_view id);

}  // namespace least::server
