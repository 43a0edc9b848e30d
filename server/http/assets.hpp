// The files of the page, embedded in the binary; the build makes the definition from web/.
#pragma once

#include <span>
#include <string_view>

namespace least::server {

/// One file: its path on the server (`/index.html`), its media type and its bytes. All of static storage.
struct Asset {
  std::string_view path, type, body;
};

std::span<const Asset> assets();

}  // namespace least::server
