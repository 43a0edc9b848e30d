// The head of an HTTP/1.1 request: request line and fields, parsed strictly (RFC 9112).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/shared/result.hpp"

namespace least::server {

/// lowered returns s with ASCII letters in lower case.
std::string lowered(std::string_view s);
/// trimmed returns s without spaces and tabs at its ends.
std::string_view trimmed(std::string_view s);

/// Refusal is the answer to a request that cannot be processed; the connection is closed after it.
struct Refusal {
  int status = 400;
  std::string detail;
};

struct RequestHead {
  std::string method, path;  ///< the path of the target without its query, which means nothing here
  std::string authority;     ///< of the target, else of `Host`; empty where there is none
  int minor = 1;             ///< HTTP/1.minor
  std::vector<std::pair<std::string, std::string>> fields;  ///< names in lower case

  /// field returns the values of a field joined with commas; empty where there is none.
  std::string field(std::string_view name) const;
  std::size_t count(std::string_view name) const;
};

/// Framing is how the body of a request is delimited, and whether the connection is kept.
struct Framing {
  bool chunked = false;
  std::uint64_t length = 0;
  bool keep_alive = true;
  bool expects_continue = false;
};

/// HeadBounds limit a head, in bytes and number of fields.
struct HeadBounds {
  std::size_t bytes = 32 * 1024, target = 8 * 1024, fields = 100;
};

/// parse_head parses a head without its final blank line. Refuses with 400, 414, 431 or 505.
Result<RequestHead, Refusal> parse_head(std::string_view text, const HeadBounds& bounds);

/// refusal_at_once returns what is wrong with an incomplete head already.
std::optional<Refusal> refusal_at_once(std::string_view begun);

/// is_field_value tells whether a text may be a field value: without control characters other than tabs.
bool is_field_value(std::string_view text);

/// framing_of refuses with 400 (contradictions), 413 (announces more than `body_limit`), 415, 417 or 501.
Result<Framing, Refusal> framing_of(const RequestHead& head, std::uint64_t body_limit);

}  // namespace least::server
