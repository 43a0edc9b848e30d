#include "server/encode/text_pieces.hpp"

#include <algorithm>
#include <span>

namespace least::server {

void TextPieces::add(bool first, std::function<void(JsonWriter&)> write) {
  pieces_.emplace_back([notation = notation_, first, write = std::move(write)](std::string& out) {
    JsonWriter json(out, notation, first);
    write(json);
  });
}

void TextPieces::add_list(std::string key, bool first, const std::vector<std::int64_t>& values) {
  add(first, [key = std::move(key)](JsonWriter& json) { json.key(key).open('['); });
  for (std::size_t from = 0; from < values.size(); from += slice)
    add(from == 0, [part = std::span(values).subspan(from, std::min(slice, values.size() - from))](JsonWriter& json) {
      for (const std::int64_t value : part) json.integer(value);
    });
  add(false, [](JsonWriter& json) { json.close(']'); });
}

void TextPieces::add_list(std::string key, bool first, const Strided& column) {
  const std::size_t rows = column.numbers.size() / column.stride;
  const bool packed = notation_ == Notation::cbor;
  add(first, [=, key = std::move(key)](JsonWriter& json) {
    json.key(key);
    packed ? begin_typed_array(json.buffer(), rows) : (void)json.open('[');
  });
  for (std::size_t from = 0; from < rows; from += slice) {
    const auto numbers = column.numbers.subspan(from * column.stride, std::min(slice, rows - from) * column.stride);
    add(from == 0, [=, part = Strided{numbers, column.first, column.stride}](JsonWriter& json) {
      packed ? append_binary(json.buffer(), part) : append_numbers(json.buffer(), part, from == 0);
    });
  }
  if (!packed) add(false, [](JsonWriter& json) { json.close(']'); });
}

void TextPieces::add_lists(std::string key, const Strided& column, const std::vector<std::int64_t>& counts) {
  add(false, [key = std::move(key)](JsonWriter& json) { json.key(key).open('['); });
  for (Place at; at.list < counts.size();) {
    const Place from = at;
    std::size_t room = slice;
    while (at.list < counts.size() && room > 0) {
      const std::size_t left = static_cast<std::size_t>(counts[at.list]) - at.within, taken = std::min(left, room);
      room -= taken;
      at = taken < left ? Place{at.list, at.within + taken, at.row + taken} : Place{at.list + 1, 0, at.row + taken};
    }
    add(from.list == 0, [=, &counts, to = at](JsonWriter& json) { write_lists(json, column, counts, from, to); });
  }
  add(false, [](JsonWriter& json) { json.close(']'); });
}

void TextPieces::write_lists(JsonWriter& json, const Strided& column, const std::vector<std::int64_t>& counts,
                             Place from, const Place& to) {
  const bool packed = json.notation() == Notation::cbor;
  while (from.list < to.list || from.within < to.within) {
    const auto count = static_cast<std::size_t>(counts[from.list]);
    const std::size_t end = from.list < to.list ? count : to.within, rows = end - from.within;
    const auto numbers = column.numbers.subspan(from.row * column.stride, rows * column.stride);
    const bool begins = from.within == 0;
    if (begins) packed ? begin_typed_array(json.buffer(), count) : (void)json.open('[');
    packed ? append_binary(json.buffer(), {numbers, column.first, column.stride})
           : append_numbers(json.buffer(), {numbers, column.first, column.stride}, begins);
    if (end == count && !packed) json.close(']');
    from = {end == count ? from.list + 1 : from.list, end == count ? 0 : end, from.row + rows};
  }
}

bool TextPieces::operator()(std::string& out) {
  constexpr std::size_t enough = 64 * 1024;  // bytes; short pieces are sent together
  const std::size_t before = out.size();
  while (next_ < pieces_.size() && out.size() - before < enough) pieces_[next_++](out);
  return next_ < pieces_.size();
}

std::string TextPieces::whole() {
  std::string text;
  while ((*this)(text)) {
  }
  return text;
}

}  // namespace least::server
