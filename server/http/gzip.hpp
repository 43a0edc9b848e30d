// Compresses answers for clients that ask for it (RFC 9110, 8.4; RFC 1952).
//
// Uses zlib directly: cpp-httplib's compressor is a detail of its header in some releases and of its library in others.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "server/shared/answer.hpp"

namespace least::server {

/// takes_gzip tells whether an `Accept-Encoding` value accepts gzip.
bool takes_gzip(std::string_view accept_encoding);

/// worth_gzip is false for short bodies, and for media types that are compressed already.
bool worth_gzip(std::string_view media_type, std::size_t bytes);

/// gzipped compresses a whole text; `level` from 1 (fast) to 9.
std::string gzipped(std::string_view text, int level);

/// compress compresses an answer, including one with a stream: each piece can be decompressed when it arrives.
void compress(Answer& answer);

}  // namespace least::server
