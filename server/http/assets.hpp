// The files of the page, embedded in the binary; the build generates the definition from web/.
#pragma once

#include <span>
#include <string_view>

namespace least::server {

/// Asset is one file: its path on the server (`/index.html`), its media type and its bytes, all with static lifetime.
struct Asset {
  std::string_view path, type, body;
};

/// assets() returns all files of the page.
std::span<const Asset> assets();

}  // namespace least::server
