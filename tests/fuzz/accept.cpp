#include "server/http/accept.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "server/http/gzip.hpp"
#include "tests/fuzz/targets.hpp"

namespace least::fuzz {

void accept(std::string_view bytes) {
  using server::negotiate;
  constexpr std::string_view offered[] = {"application/json", "text/csv", "application/cbor"};
  const auto best = negotiate(bytes, offered);
  ensure(!best || *best < std::size(offered), "a form that is not offered");
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < std::size(offered); ++i) {
    const bool taken = negotiate(bytes, {&offered[i], 1}).has_value();
    ensure(best ? i != *best || taken : !taken, "taken among others, and not alone, or the other way round");
    if (taken && !first) first = i;
  }
  std::string loud(bytes);
  std::ranges::transform(loud, loud.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
  ensure(negotiate(loud, offered) == best, "another choice in capitals");
  ensure(server::takes_gzip(loud) == server::takes_gzip(bytes), "another coding in capitals");
  const auto turned = negotiate(std::string(bytes) + ", ", offered);
  ensure(turned == best, "another choice with an empty element at the end");
}

}  // namespace least::fuzz
