// What follows from what stands on a tape: on what a value depends, its derivatives, and the same with something else
// in the place of its variables. Derivatives are values on the same tape. Source: Griewank & Walther, Evaluating
// Derivatives, 2008, 3.2 (reverse mode).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

/// The nodes that one is made of, and itself, in the order of the tape.
std::vector<Index> parts_of(const Tape& tape, Index whole);

/// On what a value depends, as bits: of kinds of variables, and the time as the last.
using Dependence = std::uint32_t;
inline constexpr Dependence on_time = Dependence(1) << 31;

/// Of the values of one tape, which may grow meanwhile; each node is looked at once.
class Dependences {
 public:
  /// `kind(i)`: the bits of the variable number i.
  Dependences(const Tape& tape, std::function<Dependence(int variable)> kind) : tape_(tape), kind_(std::move(kind)) {}
  Dependence operator()(const Symbol& y);

 private:
  const Tape& tape_;
  std::function<Dependence(int)> kind_;
  std::vector<Dependence> of_;  ///< by node
};

/// ∂y/∂x of the variables with these numbers; what is zero whatever their values is the constant 0.
std::vector<Symbol> gradient(Tape& tape, const Symbol& y, std::span<const int> variables);

/// The same of `count` variables, the first of which has the number `first`: those that are not zero whatever the
/// values, each with its place among them, in their order. `left`: operations that may be looked at, less those that
/// were; throws TooManyOperations.
std::vector<std::pair<std::size_t, Symbol>> slopes_of(Tape& tape, const Symbol& y, int first, std::size_t count,
                                                      std::size_t& left);

/// What becomes of terms that a tape keeps: they are kept, or their totals are written out, term by term.
enum class Totals : std::uint8_t { kept, written_out };

/// y as it stands on `from`, written on `to` with other symbols in the place of its variables; of time it is the same.
class Substitution {
 public:
  Substitution(const Tape& from, Tape& to, std::function<Symbol(int variable)> in_place_of,
               Totals totals = Totals::kept)
      : from_(from), to_(to), in_place_of_(std::move(in_place_of)), totals_(totals) {}
  Symbol operator()(const Symbol& y) { return y.is_constant() ? y : at(y.place()); }
  /// The same of what stands at a place.
  Symbol at(Index place);

 private:
  /// What a node is made of and was not made before, in the order of the tape, known from now on. Values that share
  /// most of their parts, as the slopes of a product do, cost what all of them have together.
  std::vector<Index> unknown_parts(Index whole);
  /// A sum of terms with their arguments substituted.
  Symbol total(const Node& node);
  Index kept_terms(Index number);
  void write_out(Index number, std::vector<Symbol>& sums);

  const Tape& from_;
  Tape& to_;
  std::function<Symbol(int)> in_place_of_;
  Totals totals_;
  std::vector<Symbol> made_;
  std::vector<bool> known_;
  std::map<Index, Index> terms_;               ///< of terms on `from` those on `to`
  std::map<Index, std::vector<Symbol>> sums_;  ///< the same, written out
};

/// A tape without terms, on which totals are written out, and where its roots stand.
struct PlainTape {
  Tape tape;
  std::vector<Index> roots;
};
/// How many operations that takes at most.
std::size_t operations_written_out(const Tape& tape);
inline constexpr Index most_written_out = 1 << 18;
/// Throws TooManyOperations where it takes more than `most`.
PlainTape written_out(const Tape& tape, std::span<const Index> roots, Index most);

}  // namespace least::tape
