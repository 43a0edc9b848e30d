// Columns of row-major samples, as text and as binary numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/shared/json_writer.hpp"

namespace least::server {

/// Strided is every `stride`-th number, beginning with number `first`.
struct Strided {
  std::span<const double> numbers;
  std::size_t first, stride;
};

/// append_numbers writes numbers separated by commas, and a comma before them unless they are the first of their array.
void append_numbers(std::string& out, const Strided& values, bool first);
/// write_words writes the words of the codes as elements of the open array.
void write_words(JsonWriter& json, const std::vector<std::string>& words, const Strided& values);

/// begin_typed_array writes the head of an RFC 8746 typed array of little-endian binary64.
void begin_typed_array(std::string& out, std::size_t numbers);
/// append_binary writes its numbers.
void append_binary(std::string& out, const Strided& values);

}  // namespace least::server
