#include "server/shared/json_writer.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace least::server {
namespace {

// One code point of UTF-8 at `i`, which moves past it; bytes that are not UTF-8 come out as U+FFFD.
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

// Whether it stands for itself in a string.
bool is_plain(char c) {
  static constexpr auto plain = [] {
    std::array<bool, 256> all{};
    for (std::size_t code = 0x20; code < 0x7F; ++code) all[code] = code != '"' && code != '\\';
    return all;
  }();
  return plain[static_cast<unsigned char>(c)];
}

// One that does not, at `i`, which moves past it.
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

static_assert(std::endian::native == std::endian::little, "write_eight would have to turn its bytes around");

constexpr auto powers_of_ten = [] {
  std::array<std::uint64_t, 20> all{1};
  for (std::size_t i = 1; i < all.size(); ++i) all[i] = 10 * all[i - 1];
  return all;
}();

int count_of_digits(std::uint64_t n) {
  const auto least = static_cast<std::size_t>(std::bit_width(n)) * 1233 >> 12;  // 3.32 bits a digit
  return static_cast<int>(least) + (n >= powers_of_ten[least] ? 1 : 0);
}

// Eight digits: two halves, then four pairs, then all of them stand side by side and are divided at once.
void write_eight(char* at, std::uint64_t n) {
  std::uint64_t sides = n / 10'000 | n % 10'000 << 32;
  const std::uint64_t hundreds = sides * 10'486 >> 20 & 0x7F'0000'007F;
  sides = hundreds | (sides - 100 * hundreds) << 16;
  const std::uint64_t tens = sides * 103 >> 10 & 0x000F'000F'000F'000F;
  sides = tens | (sides - 10 * tens) << 8 | 0x3030'3030'3030'3030;
  std::memcpy(at, &sides, sizeof sides);
}

// Of a number of so many digits, with zeros after them, as many as a double has at most.
constexpr int most_digits = 17;
void write_digits(char* at, std::uint64_t n, int count) {
  n *= powers_of_ten[static_cast<std::size_t>(most_digits - count)];
  *at = static_cast<char>('0' + n / powers_of_ten[16]);
  n %= powers_of_ten[16];
  write_eight(at + 1, n / powers_of_ten[8]);
  write_eight(at + 9, n % powers_of_ten[8]);
}

}  // namespace

// The digits are those of the library that formats; to lay them out it takes as long as to find them, as it knows every
// format there is. 320 instructions for a number of 17 digits, 470 with its layout; std::to_chars takes twice as long.
char* write_number(char* at, double x) {
  if (!std::isfinite(x)) return std::copy_n("null", 4, at);
  if (x == 0) return std::signbit(x) ? std::copy_n("-0.0", 4, at) : std::copy_n("0", 1, at);
  if (x < 0) *at++ = '-';
  const auto [digits, exponent] = fmt::detail::dragonbox::to_decimal(std::abs(x));
  const int count = count_of_digits(digits), leading = exponent + count - 1;  // the exponent of the first of them
  if (leading < -4 || leading >= 16) {
    write_digits(at + 1, digits, count);
    at[0] = at[1];
    if (count > 1) at[1] = '.', at += count;
    *++at = 'e';
    *++at = leading < 0 ? '-' : '+';
    const int size = std::abs(leading);
    if (size >= 100) *++at = static_cast<char>('0' + size / 100);
    *++at = static_cast<char>('0' + size / 10 % 10);
    *++at = static_cast<char>('0' + size % 10);
    return ++at;
  }
  if (leading < 0) {
    std::memcpy(at, "0.000", 5);
    at += 1 - leading;
    write_digits(at, digits, count);
    return at + count;
  }
  if (exponent >= 0) {
    write_digits(at, digits, count);
    return at + count + exponent;
  }
  write_digits(at + 1, digits, count);
  for (int i = 0; i <= leading; ++i) at[i] = at[i + 1];
  at[leading + 1] = '.';
  return at + count + 1;
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
  // The number in the first byte where it is small, else in the 1, 2, 4 or 8 bytes after it.
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

void append_string(std::string& out, std::string_view text, Around around, bool ascii) {
  constexpr std::size_t short_text = 64;
  if (text.size() <= short_text) {  // in one piece, as most are
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
