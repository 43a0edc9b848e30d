#include "server/http/forwarded.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>

namespace least::server {

std::string address_of(std::string_view text) {
  constexpr std::string_view mapped = "::ffff:";
  const std::string word(text);
  in_addr four{};
  in6_addr six{};
  char written[INET6_ADDRSTRLEN] = "";
  if (::inet_pton(AF_INET, word.c_str(), &four) == 1) return ::inet_ntop(AF_INET, &four, written, sizeof written);
  if (::inet_pton(AF_INET6, word.c_str(), &six) != 1) return {};
  const std::string_view address = ::inet_ntop(AF_INET6, &six, written, sizeof written);
  const bool is_four = IN6_IS_ADDR_V4MAPPED(&six);
  return std::string(address.substr(is_four ? mapped.size() : 0));
}

std::string client_of(const RequestHead& head, const std::string& peer, std::span<const std::string> trusted) {
  const auto trusts = [&](const std::string& address) { return std::ranges::find(trusted, address) != trusted.end(); };
  std::string client = peer;
  if (!trusts(peer)) return client;
  const std::string forwarded = head.field("x-forwarded-for");
  for (std::string_view rest = forwarded; !rest.empty() && trusts(client);) {
    const auto comma = rest.rfind(',');
    const auto last = comma == rest.npos ? rest : rest.substr(comma + 1);
    const std::string address = address_of(trimmed(last));
    if (address.empty()) break;
    client = address;
    rest = rest.substr(0, comma == rest.npos ? 0 : comma);
  }
  return client;
}

std::optional<std::string> request_id_of(const RequestHead& head) {
  constexpr std::size_t longest = 64;
  std::string id = head.field("x-request-id");
  const bool printable = std::all_of(id.begin(), id.end(), [](char c) { return c >= 0x20 && c < 0x7F; });
  if (head.count("x-request-id") != 1 || id.empty() || id.size() > longest || !printable) return std::nullopt;
  return id;
}

}  // namespace least::server
