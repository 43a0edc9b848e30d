// A text that is written piece by piece: of a large answer no more than a piece is in memory as text.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "server/encode/columns_out.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// What it writes has to outlive it.
class TextPieces {
 public:
  explicit TextPieces(Notation notation) : notation_(notation) {}

  /// A piece of any kind. `first`: nothing stands before it in the object that is open.
  void add(bool first, std::function<void(JsonWriter&)> write);
  /// Members of the object that is open, each a list; columns of numbers in CBOR as typed arrays.
  void add_list(std::string key, bool first, const std::vector<std::int64_t>& values);
  void add_list(std::string key, bool first, const Strided& column);
  /// A further member, a list of lists: of the column so many numbers each.
  void add_lists(std::string key, const Strided& column, const std::vector<std::int64_t>& counts);

  /// Appends the next one. False: it was the last.
  bool operator()(std::string& out);
  /// All that are left.
  std::string whole();

 private:
  /// A place in a list of lists: before a number of one of them, which is the how-manieth of all.
  struct Place {
    std::size_t list = 0, within = 0, row = 0;
  };
  static void write_lists(JsonWriter& json, const Strided& column, const std::vector<std::int64_t>& counts, Place from,
                          const Place& to);

  static constexpr std::size_t slice = 16 * 1024;  ///< numbers of a list in one piece

  const Notation notation_;
  std::vector<std::function<void(std::string&)>> pieces_;
  std::size_t next_ = 0;
};

}  // namespace least::server
