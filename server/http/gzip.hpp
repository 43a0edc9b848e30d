// Answers compressed for clients who ask for it (RFC 9110, 8.4; RFC 1952).
//
// With zlib itself: cpp-httplib's compressor is a detail of its header in some releases and of its library in others.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "server/shared/answer.hpp"

namespace least::server {

/// Whether an `Accept-Encoding` value would have gzip.
bool takes_gzip(std::string_view accept_encoding);

/// Shorter bodies, and those of types that are compressed already, are left as they are.
bool worth_gzip(std::string_view media_type, std::size_t bytes);

/// A whole text; `level` from 1 (fast) to 9.
std::string gzipped(std::string_view text, int level);

/// The answer compressed, also where its body is a stream: each piece of that can be read when it comes.
void compress(Answer& answer);

}  // namespace least::server
