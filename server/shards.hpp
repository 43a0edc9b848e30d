// Parts of an ensemble that are computed apart, on machines of a cluster or one after the other, and what they make
// together. A part is text: the echo of the request, which shard it is, a line per block of members, and how many
// blocks there are. It is written through a temporary name, so that it is whole or not there.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/endpoint.hpp"

namespace least::server {

/// Computes the shard `I/N` of the request and writes it; a part that is whole and of the same request is left alone.
/// 200 with a line that says what was done, or a problem document.
Answer write_part(const Context& context, const HttpRequest& request, const std::string& shard,
                  const std::string& output, unsigned threads);

/// The answer that the whole ensemble would have had in one run, but for its cost; or what is wrong with the parts, by
/// their names.
Answer merge_parts(const Cards& cards, const std::vector<std::string>& paths, std::string_view id);

}  // namespace least::server
