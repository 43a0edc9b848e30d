// Texts with lists, sums and definitions, written out: `sum(i=1..n, m[i]*vx[i]^2/2)` becomes a text without sums,
// definitions and symbolic indices, which an Expression reads.
//   x[i+1]   an element of a list, counted from 1; an index is made of whole numbers by + - * and mod(a, n)
//   sum(i=1..n, j=i+1..n, …)  prod(…)   an empty sum is 0, an empty product 1
//   if(i != j, u, v)   is settled where the condition compares indices: < <= > >= == !=, and, or, not; any other
//                      condition stays in the text, also one that compares whole-numbered parameters
//   r, d(i,j)   a definition; its arguments are indices
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/text/indices.hpp"

namespace least::text {

/// KeptSum is a long sum that is not written out. Terms that differ only in the names they contain share one Shape: its
/// text has placeholders `a[1]`, `a[2]`, … for these names.
struct KeptSum {
  struct Shape {
    std::string text;
    std::size_t arguments = 0, terms = 0;
    std::vector<std::uint32_t> given{};  ///< terms × arguments numbers of names (see SumNames), term by term
  };
  std::vector<Shape> shapes{};

  std::size_t bytes() const {
    std::size_t all = 0;
    for (const Shape& shape : shapes) all += shape.given.capacity() * sizeof(std::uint32_t);
    return all;
  }
};

/// SumNames numbers what the terms of kept sums refer to: names, elements of lists, and values of indices.
class SumNames {
 public:
  std::uint32_t number_of(std::string_view name) { return number_of(name, 0); }
  std::uint32_t number_of(std::string_view list, std::size_t index);
  std::uint32_t number_of(std::int64_t value);
  /// all() returns the names by number; the value of an index is written in digits.
  const std::vector<std::string>& all() const { return all_; }

 private:
  std::vector<std::string> all_;
  std::map<std::int64_t, std::uint32_t> values_;
  /// By list and index, the number plus one; 0 where the element has no number yet
  std::map<std::string, std::vector<std::uint32_t>, std::less<>> elements_;
};

/// KeptSums holds all kept sums of a scene. In a text that was written out a kept sum appears as its first term and its
/// number, `((x[1]-x[2])#0)`.
struct KeptSums {
  /// Sums of fewer terms are written out: they run as fast, and faster in implicit schemes
  std::size_t few_terms = 256;
  std::vector<KeptSum> all{};
  std::size_t terms = 0;  ///< of all of them
  SumNames names{};
  Names not_in_them{};  ///< a sum whose terms contain one of these lists or names (such as velocities) is written out
  Held held = HeldByThread::take(0);

  void clear() {
    all.clear();
    terms = 0;
    names = {};
    held.shrink_to(0);
  }
};

/// Expansion is a text written out, together with the origin of each of its parts.
class Expansion {
 public:
  /// Place is a position in the text itself, or in the text of the definition with this number in the vocabulary.
  struct Place {
    std::size_t position = 0;
    std::optional<std::size_t> definition{};
  };
  /// Wrong is a fault in the text itself, or in the text of the definition with this number.
  struct Wrong {
    Fault fault;
    std::optional<std::size_t> definition{};
  };

  /// of(text, …) writes `text` out, or returns what is wrong with it. `indices` are the values of indices that are
  /// already set. `kept` receives the sums of many terms; null writes these out, too. A text that would become too
  /// large is refused before it is written out (size_of). The work is bounded by the TextWork of the thread, or by one
  /// of its own.
  static std::variant<Expansion, Wrong> of(std::string_view text, const Vocabulary& vocabulary,
                                           const Indices& indices = {}, KeptSums* kept = nullptr);

  const std::string& text() const { return text_; }
  /// origin(position) returns where the character at a position of the written-out text comes from.
  Place origin(std::size_t position) const;
  /// used() returns the whole-number constants that bounds, indices and conditions have used.
  const Names& used() const { return used_; }

 private:
  friend class Expander;
  static constexpr std::uint32_t none = 0xffffffff;
  static std::optional<std::size_t> definition_of(std::uint32_t number) {
    return number == none ? std::nullopt : std::optional<std::size_t>(number);
  }
  /// Texts of a million characters have some 400,000 parts.
  struct Part {
    std::uint32_t at;          ///< first position in the written-out text
    std::uint32_t position;    ///< position in the text that the part comes from
    std::uint32_t definition;  ///< the number of the definition that it comes from, or `none`
    bool whole;                ///< the whole part comes from that one position
  };
  std::string text_;
  std::vector<Part> parts_;
  Names used_;
};

/// element_name("x", 3) returns `x[3]`.
std::string element_name(std::string_view list, std::int64_t index);

/// element_of(`x[3]`) returns the list and the index; nothing where the name has no numeric index.
std::optional<std::pair<std::string_view, std::int64_t>> element_of(std::string_view name);

}  // namespace least::text
