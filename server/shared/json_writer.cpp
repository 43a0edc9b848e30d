#include "server/shared/json_writer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace least::server {
namespace {

// code_point returns the code point of UTF-8 at `i` and moves `i` past it; invalid bytes give U+FFFD.
char32_t code_point(std::string_view s, std::size_t& i) {
  const auto byte = [&](std::size_t k) { return k < s.size() ? static_cast<unsigned char>(s[k]) : 0u; };
  const unsigned lead = byte(i);
  const std::size_t length = lead < 0x80 ? 1 : lead >> 5 == 6 ? 2 : lead >> 4 == 14 ? 3 : lead >> 3 == 30 ? 4 : 0;
  char32_t code = length < 2 ? lead : lead & (0x7Fu >> length);
  bool good = length > 0;
  for (std::size_t k = 1; k < length; ++k) {
    good = good && byte(i + k) >> 6 == 2;
    code = code << 6 | (byte(i + k) & 0x3F);
  }
  i += good ? length : 1;
  return good ? code : U'\uFFFD';
}

// is_plain tells whether a character needs no escape in a string.
bool is_plain(char c) {
  static constexpr auto plain = [] {
    std::array<bool, 256> all{};
    for (std::size_t code = 0x20; code < 0x7F; ++code) all[code] = code != '"' && code != '\\';
    return all;
  }();
  return plain[static_cast<unsigned char>(c)];
}

// escape writes the character at `i` escaped and moves `i` past it.
void escape(std::string& out, std::string_view text, std::size_t& i, bool ascii) {
  const char c = text[i];
  if (c == '"' || c == '\\') {
    out += '\\';
    out += c;
    ++i;
  } else if (static_cast<unsigned char>(c) < 0x80) {
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("\\u{:04x}"), static_cast<unsigned>(c));
    ++i;
  } else {
    const std::size_t from = i;
    const auto code = static_cast<unsigned>(code_point(text, i));
    if (!ascii && code != 0xFFFD) {
      out += text.substr(from, i - from);
    } else if (code < 0x10000) {
      fmt::format_to(std::back_inserter(out), FMT_COMPILE("\\u{:04x}"), code);
    } else {
      fmt::format_to(std::back_inserter(out), FMT_COMPILE("\\u{:04x}\\u{:04x}"), 0xD800 + ((code - 0x10000) >> 10),
                     0xDC00 + ((code - 0x10000) & 0x3FF));
    }
  }
}

}  // namespace

// Takes 25 ns for a number of few digits, 45 ns for one of 17; std::to_chars takes 47 ns in the same layout.
char* write_number(char* at, double x) {
  if (!std::isfinite(x)) return std::copy_n("null", 4, at);
  if (x == 0) return std::signbit(x) ? std::copy_n("-0.0", 4, at) : std::copy_n("0", 1, at);
  return fmt::format_to(at, FMT_COMPILE("{}"), x);
}

void append_number(std::string& out, double x, bool comma) {
  char text[1 + longest_number] = {','};
  out.append(text + !comma, write_number(text + 1, x));
}

void append_number(std::string& out, std::int64_t n, bool comma) {
  char text[24] = {','};
  char* end = fmt::format_to(text + 1, FMT_COMPILE("{}"), n);
  out.append(text + !comma, end);
}

void append_cbor_head(std::string& out, unsigned major, std::uint64_t number) {
  // Small arguments are in the first byte, others in the 1, 2, 4 or 8 bytes after it.
  const int size = number < 24                       ? 0
                   : number < 1u << 8                ? 1
                   : number < 1u << 16               ? 2
                   : number < std::uint64_t{1} << 32 ? 4
                                                     : 8;
  const unsigned info = size == 0   ? static_cast<unsigned>(number)
                        : size == 1 ? 24
                        : size == 2 ? 25
                        : size == 4 ? 26
                                    : 27;
  out += static_cast<char>(major << 5 | info);
  for (int byte = size - 1; byte >= 0; --byte) out += static_cast<char>(number >> (8 * byte) & 0xFF);
}

void append_cbor(std::string& out, double x) {
  if (!std::isfinite(x)) {
    out += static_cast<char>(0xF6);
    return;
  }
  out += static_cast<char>(0xFB);
  const auto bits = std::bit_cast<std::uint64_t>(x);
  for (int byte = 7; byte >= 0; --byte) out += static_cast<char>(bits >> (8 * byte) & 0xFF);
}

void append_string(std::string& out, std::string_view text, bool ascii) { append_string(out, text, {}, ascii); }

void append_string(std::string& out, std::string_view text, Separators around, bool ascii) {
  constexpr std::size_t short_text = 64;
  if (text.size() <= short_text) {  // in one piece, as most texts are short
    char piece[short_text + 4];
    char* at = piece;
    if (around.comma) *at++ = ',';
    *at++ = '"';
    bool plain = true;
    for (const char c : text) {
      plain = plain && is_plain(c);
      *at++ = c;
    }
    *at++ = '"';
    if (around.colon) *at++ = ':';
    if (plain) return void(out.append(piece, at));
  }
  if (around.comma) out += ',';
  out += '"';
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t from = i;
    while (i < text.size() && is_plain(text[i])) ++i;
    out.append(text, from, i - from);
    if (i < text.size()) escape(out, text, i, ascii);
  }
  out += '"';
  if (around.colon) out += ':';
}

}  // namespace least::server
