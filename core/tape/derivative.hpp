// Dependences, derivatives and substitutions of values on a tape. Derivatives are values on the same tape. Source:
// Griewank & Walther, Evaluating Derivatives, 2008, 3.2 (reverse mode).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

/// Returns the node `whole` and all nodes from which it is computed, in the order of the tape.
std::vector<Index> parts_of(const Tape& tape, Index whole);

/// Dependence is a bit set of the kinds of variables on which a value depends; the highest bit stands for the time.
using Dependence = std::uint32_t;
inline constexpr Dependence on_time = Dependence(1) << 31;

/// Dependences tells on which kinds of variables the values of one tape depend. The tape may grow between calls; each
/// node is examined once.
class Dependences {
 public:
  /// `kind(i)` returns the bits of variable number i.
  Dependences(const Tape& tape, std::function<Dependence(int variable)> kind) : tape_(tape), kind_(std::move(kind)) {}
  Dependence operator()(const Symbol& y);

 private:
  const Tape& tape_;
  std::function<Dependence(int)> kind_;
  std::vector<Dependence> of_;  ///< by node
};

/// Returns ∂y/∂x for the variables with these numbers, in this order. An entry is the constant 0 where y does not
/// depend on the variable.
std::vector<Symbol> gradient(Tape& tape, const Symbol& y, std::span<const int> variables);

/// Returns ∂y/∂x for the variables number first … first + count − 1 as pairs of (number − first, derivative) in
/// ascending order, without those that are identically zero. `left` is the number of operations that may still be
/// examined; the call reduces it by the operations of y and throws TooManyOperations if they are more.
std::vector<std::pair<std::size_t, Symbol>> slopes_of(Tape& tape, const Symbol& y, int first, std::size_t count,
                                                      std::size_t& left);

/// Whether a substitution keeps the terms of a tape as terms, or writes their totals out term by term.
enum class Totals : std::uint8_t { kept, written_out };
/// Whether a substitution keeps a^b whose exponent is no number (Op::raise), or writes it as exp(b log a).
enum class Powers : std::uint8_t { kept, exponentials };

/// Substitution writes values of the tape `from` on the tape `to`, with the symbol in_place_of(i) in the place of
/// variable i. The time stays the time.
class Substitution {
 public:
  Substitution(const Tape& from, Tape& to, std::function<Symbol(int variable)> in_place_of,
               Totals totals = Totals::kept, Powers powers = Powers::kept)
      : from_(from), to_(to), in_place_of_(std::move(in_place_of)), totals_(totals), powers_(powers) {}
  Symbol operator()(const Symbol& y) { return y.is_constant() ? y : at(y.place()); }
  /// The same for the node at `place` of `from`.
  Symbol at(Index place);

 private:
  /// Returns the parts of a node that are not written yet, in the order of the tape, and marks them as known. Values
  /// that share most of their parts, such as the derivatives of a product, thus cost each shared part once.
  std::vector<Index> unknown_parts(Index whole);
  /// The sum of terms that the node stands for, with the arguments of the terms substituted.
  Symbol total(const Node& node);
  Index kept_terms(Index number);
  void write_out(Index number, std::vector<Symbol>& sums);

  const Tape& from_;
  Tape& to_;
  std::function<Symbol(int)> in_place_of_;
  Totals totals_;
  Powers powers_;
  std::vector<Symbol> made_;
  std::vector<bool> known_;
  std::map<Index, Index> terms_;               ///< the number of terms on `to` by their number on `from`
  std::map<Index, std::vector<Symbol>> sums_;  ///< sums by the number of their terms on `from`, written out
};

/// A tape on which something is written otherwise, and the places of its roots.
struct PlainTape {
  Tape tape;
  std::vector<Index> roots;
};
/// Estimates the number of operations of the tape with its totals written out.
std::size_t operations_written_out(const Tape& tape);
inline constexpr Index most_written_out = 1 << 18;
/// Writes the roots on a plain tape; throws TooManyOperations where that takes more than `most` operations.
PlainTape written_out(const Tape& tape, std::span<const Index> roots, Index most);
/// has_moving_exponents tells whether there is an a^b on the tape whose exponent is no number.
bool has_moving_exponents(const Tape& tape);
/// with_exponentials writes the roots on another tape, on which every such power is exp(b log a); sums of terms are
/// kept.
PlainTape with_exponentials(const Tape& tape, std::span<const Index> roots);

}  // namespace least::tape
