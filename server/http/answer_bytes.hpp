// An answer as the bytes of HTTP/1.1: its head, and its body in chunks.
#pragma once

#include <string>
#include <string_view>

#include "server/shared/answer.hpp"

namespace least::server {

/// The head, with room for the body behind it; `chunked`: so is that.
std::string head_of(const Answer& answer, bool keep_alive, bool chunked);

/// A piece of a body as a chunk (RFC 9112, 7.1); where it is not chunked, which is in HTTP/1.0, it is bare, and the
/// body ends with the connection.
std::string chunk_of(std::string_view piece, bool chunked);
inline std::string_view end_of_chunks(bool chunked) { return chunked ? "0\r\n\r\n" : ""; }

}  // namespace least::server
