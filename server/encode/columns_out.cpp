#include "server/encode/columns_out.hpp"

#include <bit>
#include <cstdint>
#include <cstring>

#include "server/encode/answer_parts.hpp"

namespace least::server {

static_assert(std::endian::native == std::endian::little, "append_binary would have to turn the bytes around");

void append_numbers(std::string& out, const Strided& values, bool first) {
  char block[8192];  // small enough for the cache
  char* at = block;
  for (std::size_t i = values.first; i < values.numbers.size(); i += values.stride) {
    if (at > block + sizeof block - longest_number - 1) {
      out.append(block, at);
      at = block;
    }
    if (!first || i != values.first) *at++ = ',';
    at = write_number(at, values.numbers[i]);
  }
  out.append(block, at);
}

void write_words(JsonWriter& json, const std::vector<std::string>& words, const Strided& values) {
  for (std::size_t i = values.first; i < values.numbers.size(); i += values.stride) {
    const auto word = word_of(words, values.numbers[i]);
    word.empty() ? json.null() : json.text(word);
  }
}

void begin_typed_array(std::string& out, std::size_t numbers) {
  constexpr unsigned char tag[] = {0xD8, 86};
  out.append(reinterpret_cast<const char*>(tag), sizeof tag);
  append_cbor_head(out, 2, numbers * sizeof(double));
}

void append_binary(std::string& out, const Strided& values) {
  char block[8192];
  char* at = block;
  for (std::size_t i = values.first; i < values.numbers.size(); i += values.stride) {
    if (at == block + sizeof block) {
      out.append(block, at);
      at = block;
    }
    at = static_cast<char*>(std::memcpy(at, &values.numbers[i], sizeof(double))) + sizeof(double);
  }
  out.append(block, at);
}

}  // namespace least::server
