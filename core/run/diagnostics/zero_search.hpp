// Between which times an expression may pass through zero. A stretch of a run is divided until interval arithmetic on
// the graph of the expression says of every piece that the expression has no zero there, or is monotone there: the
// looks follow the expression and not the step. What variables do on a piece is a polynomial through five states of the
// dense output, which are taken anew where a piece has become so short that the error of the polynomial matters.
// Source: Moore, Kearfott & Cloud, Introduction to Interval Analysis, 2009, chapters 6 and 8.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/run/measures.hpp"
#include "core/run/request.hpp"

namespace least {

class ZeroSearch {
 public:
  /// One bit for each expression.
  using Bits = std::uint32_t;
  /// Writes what `observe` says of the state at a time; false: there is none.
  using ObserveAt = std::function<bool(double t, double* observed)>;
  enum class Kind : std::uint8_t {
    monotone,   ///< the expression is monotone: it has a zero where its signs at both ends differ, and no other
    round_off,  ///< it is zero all along, but for round-off
    edge,       ///< as short as time can tell, and not defined all along: an end of what is defined, or a pole
    open        ///< may hold more than one zero
  };
  struct Bracket {
    double from, to;
    Kind kind;
    double noise = 0;  ///< what round-off does to values at most; 0 where that is not known
  };

  /// `effort`: how many times a piece may be divided.
  ZeroSearch(const Measures& measures, const ObserveAt& observe_at, int effort);

  /// `pieces`: how many equal ones to begin with.
  void find(double from, double to, int pieces);
  /// What was found of an expression, in the order of time.
  const std::vector<Bracket>& brackets(std::size_t which) const { return brackets_[which]; }
  /// Whether `find` might find any, by those pieces alone.
  bool may_find(double from, double to, int pieces);
  /// Those that would have to be looked at more closely than the effort allows, or than time can be told.
  Bits unresolved() const { return unresolved_; }

 private:
  /// A variable on a piece: a polynomial in u, which is −1 at the beginning and 1 at the end.
  struct Curve {
    std::array<double, 5> c;
    double error;       ///< of its values
    double round_off;   ///< what of that is round-off, of values and of time
    double rate_error;  ///< of its derivative with respect to time
  };
  struct Piece {
    double from, to;
    Bits open;  ///< which expressions are still asked about
    bool known = false;
    std::vector<Curve> curves;  ///< of the variables that are read; none where the states are not known

    double middle() const { return from + (to - from) / 2; }
    double radius() const { return (to - from) / 2; }
  };

  Piece sampled(double from, double to, Bits open);
  Piece half(const Piece& whole, bool second, Bits open, bool anew);
  /// Whether states of its own would say more of a piece than those that its curves were made from.
  static bool gains_by_states(const Piece& piece);
  static bool exact(const Piece& piece);
  /// Of the expressions that may vanish on a piece and are not monotone there; those that are become brackets.
  Bits examine(const Piece& piece);
  void search(const Piece& piece);
  void leave(const Piece& piece, Bits open);
  void add(const Piece& piece, std::size_t which, Kind kind, double noise = 0);
  void enclose(const Piece& piece);
  void enclose_middle(const Piece& piece);

  const Measures& measures_;
  const ObserveAt& observe_at_;
  int effort_;
  double shortest_ = 0;  ///< radius of a piece
  double vague_ = 0;     ///< radius: on shorter pieces states are smooth but for round-off, or there are none
  Bits unresolved_ = 0;
  bool needs_states_ = false;      ///< what was examined last was hidden by the error of its curves
  std::vector<std::size_t> read_;  ///< which of the variables
  std::vector<double> observed_;
  std::vector<interval::Enclosure> points_;     ///< variables in the middle of a piece
  std::vector<interval::RateEnclosure> boxes_;  ///< and all along it
  std::array<interval::Enclosure, most_watched> middle_;
  std::array<interval::RateEnclosure, most_watched> whole_;
  std::array<double, most_watched> scale_{};  ///< the largest value that was met
  std::array<std::vector<Bracket>, most_watched> brackets_;
  std::vector<std::pair<std::size_t, double>> wild_;  ///< expressions, and times at which they may still be anything
};

}  // namespace least
