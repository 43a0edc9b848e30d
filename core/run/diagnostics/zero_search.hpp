// Times between which an expression may pass through zero. A part of a run is divided until interval arithmetic on the
// graph of the expression proves for every piece that the expression has no zero there, or is monotone there, so the
// number of pieces depends on the expression and not on the step. Variables on a piece are polynomials through five
// states of the dense output, which are computed anew once a piece is so short that the error of the polynomial
// matters. Source: Moore, Kearfott & Cloud, Introduction to Interval Analysis, 2009, chapters 6 and 8.
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
  /// Writes the observation (`observe`) of the state at a time; false if there is none.
  using ObserveAt = std::function<bool(double t, double* observed)>;
  enum class Kind : std::uint8_t {
    monotone,   ///< the expression is monotone: one zero if its signs at both ends differ, else none
    round_off,  ///< it is zero everywhere up to round-off
    edge,       ///< as short as time resolves, and not defined everywhere: an end of the domain, or a pole
    open        ///< may hold more than one zero
  };
  struct Bracket {
    double from, to;
    Kind kind;
    double noise = 0;  ///< bound on the round-off of values; 0 if it is not known
  };

  /// `effort`: how many times a piece may be divided in all.
  ZeroSearch(const Measures& measures, const ObserveAt& observe_at, int effort);

  /// Searches from `from` to `to`; `pieces` is the number of equal pieces at first.
  void find(double from, double to, int pieces);
  /// The brackets found for an expression, in order of time.
  const std::vector<Bracket>& brackets(std::size_t which) const { return brackets_[which]; }
  /// Whether `find` might find any bracket, judged by the first pieces alone.
  bool may_find(double from, double to, int pieces);
  /// Expressions that would need a closer search than the effort allows, or than time resolves.
  Bits unresolved() const { return unresolved_; }

 private:
  /// Curve is a variable on a piece: a polynomial in u, which is −1 at the beginning and 1 at the end.
  struct Curve {
    std::array<double, 5> c;
    double error;       ///< bound on the error of its values
    double round_off;   ///< the part of `error` that is round-off, of values and of time
    double rate_error;  ///< bound on the error of its time derivative
  };
  struct Piece {
    double from, to;
    Bits open;  ///< expressions that are not decided yet
    bool known = false;
    std::vector<Curve> curves;  ///< one for each variable that is read

    double middle() const { return from + (to - from) / 2; }
    double radius() const { return (to - from) / 2; }
  };

  Piece sampled(double from, double to, Bits open);
  Piece half(const Piece& whole, bool second, Bits open, bool anew);
  /// Whether new states on a piece would tell more than its curves, which come from a longer piece.
  static bool gains_by_states(const Piece& piece);
  static bool exact(const Piece& piece);
  /// examine returns the expressions that may vanish on a piece and are not monotone there; those that are monotone
  /// become brackets.
  Bits examine(const Piece& piece);
  void search(const Piece& piece);
  void leave(const Piece& piece, Bits open);
  void add(const Piece& piece, std::size_t which, Kind kind, double noise = 0);
  void enclose(const Piece& piece);
  void enclose_middle(const Piece& piece);

  const Measures& measures_;
  const ObserveAt& observe_at_;
  int effort_;
  double shortest_ = 0;  ///< smallest radius of a piece
  double vague_ = 0;     ///< radius below which states are smooth up to round-off, or do not exist
  Bits unresolved_ = 0;
  bool needs_states_ = false;      ///< whether the error of the curves hid the last piece examined
  std::vector<std::size_t> read_;  ///< indices of the variables that are read
  std::vector<double> observed_;
  std::vector<interval::Enclosure> points_;     ///< variables in the middle of a piece
  std::vector<interval::RateEnclosure> boxes_;  ///< and on the whole piece
  std::array<interval::Enclosure, most_watched> middle_;
  std::array<interval::RateEnclosure, most_watched> whole_;
  std::array<double, most_watched> scale_{};  ///< the largest value seen of each expression
  std::array<std::vector<Bracket>, most_watched> brackets_;
  std::vector<std::pair<std::size_t, double>> wild_;  ///< expressions, and times at which their values are not bounded
};

}  // namespace least
