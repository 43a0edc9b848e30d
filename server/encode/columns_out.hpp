// Columns of samples, as text and as binary numbers. Rows lie one after the other in memory.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/shared/json_writer.hpp"

namespace least::server {

/// Every `stride`-th number from `first` on.
struct Strided {
  std::span<const double> numbers;
  std::size_t first, stride;
};

/// With commas between, and one before unless they are the first of their array.
void append_numbers(std::string& out, const Strided& values, bool first);
/// As elements of an array that is open.
void write_words(JsonWriter& json, const std::vector<std::string>& words, const Strided& values);

/// The beginning of an RFC 8746 typed array of binary64 in little endian.
void begin_typed_array(std::string& out, std::size_t numbers);
/// Its numbers.
void append_binary(std::string& out, const Strided& values);

}  // namespace least::server
