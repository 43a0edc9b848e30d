// Texts that speak of many of a kind, written out: what `sum(i=1..n, m[i]*vx[i]^2/2)` stands for, without sums,
// definitions and indices but numbers, as an Expression reads it.
//   x[i+1]   an element of a list, counted from 1; an index is made of whole numbers by + - * and mod(a, n)
//   sum(i=1..n, j=i+1..n, …)  prod(…)   of nothing they are 0 and 1
//   if(i != j, u, v)   where the condition compares indices: < <= > >= == !=, and, or, not; others stay as they are,
//                      also those of parameters that are whole
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

/// A sum of many terms that is kept as one: of the terms that read alike but for what they speak of, their common text,
/// in which `a[1]`, `a[2]` … stand for that.
struct KeptSum {
  struct Shape {
    std::string text;
    std::size_t arguments = 0, terms = 0;
    std::vector<std::uint32_t> given{};  ///< by term, then by argument: the number of a name
  };
  std::vector<Shape> shapes{};

  std::size_t bytes() const {
    std::size_t all = 0;
    for (const Shape& shape : shapes) all += shape.given.capacity() * sizeof(std::uint32_t);
    return all;
  }
};

/// What terms of sums speak of, by numbers: names, elements of lists, and what indices are as numbers.
class SumNames {
 public:
  std::uint32_t number_of(std::string_view name) { return number_of(name, 0); }
  std::uint32_t number_of(std::string_view list, std::size_t index);
  std::uint32_t number_of(std::int64_t value);
  /// By their numbers; a value as its digits.
  const std::vector<std::string>& all() const { return all_; }

 private:
  std::vector<std::string> all_;
  std::map<std::int64_t, std::uint32_t> values_;
  std::map<std::string, std::vector<std::uint32_t>, std::less<>> elements_;  ///< one more; 0 where unknown
};

/// The kept sums of the texts of a scene. A text written out has the first term of each, and its number:
/// `((x[1]-x[2])#0)`.
struct KeptSums {
  std::size_t few_terms = 256;  ///< fewer are written out: each by itself is as fast, by implicit schemes faster
  std::vector<KeptSum> all{};
  SumNames names{};
  Names not_in_them{};  ///< lists and names, as of velocities, that the terms of no kept sum speak of
  Held held = HeldByThread::take(0);

  void clear() {
    all.clear();
    names = {};
    held.shrink_to(0);
  }
};

/// A text written out, and where its parts come from.
class Expansion {
 public:
  /// A place in the text, or in that of a definition of the vocabulary.
  struct Place {
    std::size_t position = 0;
    std::optional<std::size_t> definition{};
  };
  /// What is wrong, in the text or in that of a definition.
  struct Wrong {
    Fault fault;
    std::optional<std::size_t> definition{};
  };

  /// `indices`: what has a value already. `kept`: gets sums of many terms; none: they are written out, too. Takes no
  /// longer than most_written characters do.
  static std::variant<Expansion, Wrong> of(std::string_view text, const Vocabulary& vocabulary,
                                           const Indices& indices = {}, KeptSums* kept = nullptr);

  const std::string& text() const { return text_; }
  /// Where the character at a place of the text written out comes from.
  Place origin(std::size_t position) const;
  /// The whole constants that bounds, indices and conditions used.
  const Names& used() const { return used_; }

 private:
  friend class Expander;
  struct Part {
    std::size_t at;        ///< where it begins, written out
    std::size_t position;  ///< and where it comes from
    bool whole;            ///< all of it comes from that one place
    std::optional<std::size_t> definition;
  };
  std::string text_;
  std::vector<Part> parts_;
  Names used_;
};

/// The name of an element of a list: `x[3]`.
std::string element_name(std::string_view list, std::int64_t index);

/// A name with an index that is a number: the list and the number, or nothing.
std::optional<std::pair<std::string_view, std::int64_t>> element_of(std::string_view name);

}  // namespace least::text
