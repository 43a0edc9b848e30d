// What a proxy says of the client behind it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/http/request_head.hpp"

namespace least::server {

/// An address as the system writes it, `127.0.0.1` for `::ffff:127.0.0.1`; empty where the text is none.
std::string address_of(std::string_view text);

/// The address of the client: that of its connection, or where this is a trusted proxy, the last of `X-Forwarded-For`
/// that is no trusted proxy itself: what stands before it anybody may have written.
std::string client_of(const RequestHead& head, const std::string& peer, std::span<const std::string> trusted);

/// The `X-Request-Id` of a request where it can be kept: one of at most 64 printable characters of ASCII.
std::optional<std::string> request_id_of(const RequestHead& head);

}  // namespace least::server
