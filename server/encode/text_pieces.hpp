// A text that is written piece by piece, so that only one piece of a large answer is in memory as text.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "server/encode/columns_out.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// TextPieces; all data that it writes must outlive it.
class TextPieces {
 public:
  explicit TextPieces(Notation notation) : notation_(notation) {}

  /// add appends a piece. `first`: it is the first member of the open object.
  void add(bool first, std::function<void(JsonWriter&)> write);
  /// add_list appends a member of the open object that is a list; in CBOR, columns of numbers become typed arrays.
  void add_list(std::string key, bool first, const std::vector<std::int64_t>& values);
  void add_list(std::string key, bool first, const Strided& column);
  /// add_lists appends a further member, a list of lists with counts[k] numbers of the column each.
  void add_lists(std::string key, const Strided& column, const std::vector<std::int64_t>& counts);

  /// The call operator appends the next piece to `out`. False: it was the last.
  bool operator()(std::string& out);
  /// whole() returns all pieces that are left.
  std::string whole();

 private:
  /// Place is a position in a list of lists: before number `within` of list `list`, which is number `row` of the
  /// column.
  struct Place {
    std::size_t list = 0, within = 0, row = 0;
  };
  static void write_lists(JsonWriter& json, const Strided& column, const std::vector<std::int64_t>& counts, Place from,
                          const Place& to);

  static constexpr std::size_t slice = 16 * 1024;  ///< numbers of a list per piece

  const Notation notation_;
  std::vector<std::function<void(std::string&)>> pieces_;
  std::size_t next_ = 0;
};

}  // namespace least::server
