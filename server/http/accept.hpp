// Content negotiation (RFC 9110, 12.5.1).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace least::server {

/// negotiate returns the index of the offered media type that an `Accept` value prefers; ties are decided by the order
/// of the offer. An empty value accepts anything. Nothing: no offer is acceptable.
std::optional<std::size_t> negotiate(std::string_view accept, std::span<const std::string_view> offered);

}  // namespace least::server
