// The bytes of an answer in HTTP/1.1: its head, and its body in chunks.
#pragma once

#include <string>
#include <string_view>

#include "server/shared/answer.hpp"

namespace least::server {

/// head_of returns the head, in a string with room for the body. `chunked`: the body will be sent in chunks.
std::string head_of(const Answer& answer, bool keep_alive, bool chunked);

/// chunk_of returns a piece of a body as a chunk (RFC 9112, 7.1). If not `chunked`, as in HTTP/1.0, the piece is bare,
/// and the end of the connection marks the end of the body.
std::string chunk_of(std::string_view piece, bool chunked);
inline std::string_view end_of_chunks(bool chunked) { return chunked ? "0\r\n\r\n" : ""; }

}  // namespace least::server
