// The head of an HTTP/1.1 request: its first line and its fields, read strictly (RFC 9112).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/shared/result.hpp"

namespace least::server {

/// With the letters of ASCII in lower case.
std::string lowered(std::string_view s);
/// Without spaces and tabs at its ends.
std::string_view trimmed(std::string_view s);

/// A request that cannot be taken: what to answer before the connection is closed.
struct Refusal {
  int status = 400;
  std::string detail;
};

struct RequestHead {
  std::string method, path, query;
  std::string authority;                                    ///< of the target, else of `Host`; empty: none
  int minor = 1;                                            ///< HTTP/1.minor
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in lower case

  /// The values of a field joined with commas; empty where there is none.
  std::string field(std::string_view name) const;
  std::size_t count(std::string_view name) const;
};

/// How the body of a request is delimited, and what becomes of the connection.
struct Framing {
  bool chunked = false;
  std::uint64_t length = 0;
  bool keep_alive = true;
  bool expects_continue = false;
};

/// Bounds on a head, in bytes and fields.
struct HeadBounds {
  std::size_t bytes = 32 * 1024, target = 8 * 1024, fields = 100;
};

/// Reads a head, from the first line to before the blank one. Refuses with 400, 414, 431 or 505.
Result<RequestHead, Refusal> parse_head(std::string_view text, const HeadBounds& bounds);

/// What can be said against a head of which this much came, without waiting for the rest.
std::optional<Refusal> refusal_at_once(std::string_view begun);

/// Whether a text may stand in a field: no control characters but tabs.
bool is_field_value(std::string_view text);

/// Refuses with 400 (contradictions), 413 (more than `body_limit` announced), 415, 417 or 501.
Result<Framing, Refusal> framing_of(const RequestHead& head, std::uint64_t body_limit);

}  // namespace least::server
