#include "server/http/accept.hpp"

#include <algorithm>
#include <charconv>

#include "server/http/request_head.hpp"

namespace least::server {
namespace {

bool same(std::string_view a, std::string_view b) { return lowered(a) == lowered(b); }

// cut removes the text up to the first separator from `s` and returns it.
std::string_view cut(std::string_view& s, char separator) {
  const auto at = std::min(s.find(separator), s.size());
  const auto head = s.substr(0, at);
  s.remove_prefix(std::min(at + 1, s.size()));
  return trimmed(head);
}

double weight(std::string_view parameters) {
  while (!parameters.empty()) {
    auto value = cut(parameters, ';');
    const auto name = cut(value, '=');
    double q = 1;
    if (!same(name, "q")) continue;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), q);
    return error == std::errc() && q >= 0 && q <= 1 ? q : 0;
  }
  return 1;
}

// precision returns how exactly a media range matches a type: 0 not at all, 1 `*/*`, 2 `text/*`, 3 `text/csv`.
int precision(std::string_view range, std::string_view type) {
  if (range == "*/*" || range == "*") return 1;
  if (same(range, type)) return 3;
  const auto slash = type.find('/') + 1;
  return range.size() == slash + 1 && range.back() == '*' && same(range.substr(0, slash), type.substr(0, slash)) ? 2
                                                                                                                 : 0;
}

}  // namespace

std::optional<std::size_t> negotiate(std::string_view accept, std::span<const std::string_view> offered) {
  const bool asks_nothing = accept.find_first_not_of(" \t,") == accept.npos;  // empty elements do not count
  if (asks_nothing) return offered.empty() ? std::nullopt : std::optional<std::size_t>(0);
  std::optional<std::size_t> best;
  double most = 0;
  for (std::size_t i = 0; i < offered.size(); ++i) {
    int exactness = 0;
    double q = 0;
    for (std::string_view rest = accept; !rest.empty();) {
      std::string_view parameters = cut(rest, ',');
      const auto range = cut(parameters, ';');
      const int p = precision(range, offered[i]);
      if (p > exactness) {
        exactness = p;
        q = weight(parameters);
      }
    }
    if (q > most) {
      most = q;
      best = i;
    }
  }
  return best;
}

}  // namespace least::server
