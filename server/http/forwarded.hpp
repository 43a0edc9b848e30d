// What a proxy reports of the client behind it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/http/request_head.hpp"

namespace least::server {

/// address_of returns an address in the system's notation, `127.0.0.1` for `::ffff:127.0.0.1`; empty where the text is
/// no address.
std::string address_of(std::string_view text);

/// client_of returns the address of the client: that of the connection, or, where this is a trusted proxy, the last one
/// of `X-Forwarded-For` that is not itself a trusted proxy, as anybody may have written what precedes it.
std::string client_of(const RequestHead& head, const std::string& peer, std::span<const std::string> trusted);

/// request_id_of returns the `X-Request-Id` of a request if it has at most 64 printable ASCII characters.
std::optional<std::string> request_id_of(const RequestHead& head);

}  // namespace least::server
