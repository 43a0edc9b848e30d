// What follows from what stands on a tape: on what a value depends, its derivatives, and the same with something else
// in the place of its variables. Derivatives are values on the same tape. Source: Griewank & Walther, Evaluating
// Derivatives, 2008, 3.2 (reverse mode).
#pragma once

#include <cstdint>
#include <functional>
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

/// y as it stands on `from`, written on `to` with other symbols in the place of its variables; of time it is the same.
class Substitution {
 public:
  Substitution(const Tape& from, Tape& to, std::function<Symbol(int variable)> in_place_of)
      : from_(from), to_(to), in_place_of_(std::move(in_place_of)) {}
  Symbol operator()(const Symbol& y);

 private:
  const Tape& from_;
  Tape& to_;
  std::function<Symbol(int)> in_place_of_;
  std::vector<Symbol> made_;
  std::vector<bool> known_;
};

}  // namespace least::tape
