// A recording number: arithmetic with it appends operations to a list, unchanged except that products with 0 and 1 and
// sums with 0 are dropped. Hence running the list gives bitwise the results of the recorded code, except for signs of
// zeros and for 0 · ∞ where no formula asks for it. Taking a step of a scheme with these numbers in the place of state,
// time and step gives a program that lanes can run (core/ensemble/lane_program.hpp).
#pragma once

#include <utility>
#include <vector>

#include "core/ensemble/lane_program.hpp"
#include "core/number/parse.hpp"
#include "core/scheme.hpp"

namespace least {

/// Trace is the list of operations. A Place is the index of a node.
class Trace {
 public:
  using Place = std::int32_t;
  enum class Kind : std::uint8_t { constant, time, step, variable, operation };
  struct Node {
    Kind kind = Kind::operation;
    LaneCode code = LaneCode::copy;
    Place a = -1, b = -1, c = -1;  ///< operands; of a variable its number, of a constant its index in constants()
    friend bool operator==(const Node&, const Node&) = default;
  };
  /// Limit of nodes; beyond it nothing more is written.
  static constexpr std::size_t most_nodes = 200'000;

  Place write(const Node& node);
  Place constant(double value);
  /// Time and step are nodes 0 and 1.
  Trace();

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<double>& constants() const { return constants_; }
  Place size() const { return static_cast<Place>(nodes_.size()); }
  bool full() const { return nodes_.size() >= most_nodes; }
  /// make_room() reserves address space for most_nodes, so that writing does not throw from now on.
  void make_room();
  /// close() releases spare memory; nothing may be written afterwards.
  void close();

 private:
  std::vector<Node> nodes_;
  std::vector<double> constants_;
};

/// Traced is either a constant, which is folded, or a node of a trace.
class Traced {
 public:
  constexpr Traced() = default;
  constexpr Traced(double constant)
      : constant_(constant) {}  // NOLINT(google-explicit-constructor): a number like any other
  static Traced time(Trace& trace) { return {trace, 0}; }
  static Traced step(Trace& trace) { return {trace, 1}; }
  /// unfolded returns a constant that is not folded: its value may differ for each user of the trace.
  static Traced unfolded(Trace& trace, double value) { return {trace, trace.constant(value)}; }
  static Traced variable(Trace& trace, std::size_t i) {
    return {trace, trace.write({Trace::Kind::variable, {}, static_cast<Trace::Place>(i)})};
  }

  constexpr bool is_constant() const { return !trace_; }
  double constant() const { return constant_; }
  /// on returns the node; a constant is written first.
  Trace::Place on(Trace& trace) const { return trace_ ? place_ : trace.constant(constant_); }

  friend Traced operator+(const Traced& a, const Traced& b);
  friend Traced operator-(const Traced& a, const Traced& b);
  friend Traced operator*(const Traced& a, const Traced& b);
  friend Traced operator/(const Traced& a, const Traced& b);
  friend Traced scaled(const Traced& x, double factor);
  Traced operator-() const { return Traced(-1) * *this; }
  Traced& operator+=(const Traced& x) { return *this = *this + x; }

  friend Traced sqrt(const Traced& x);
  friend Traced exp(const Traced& x);
  friend Traced expm1(const Traced& x);
  friend Traced log(const Traced& x);
  friend Traced sin(const Traced& x);
  friend Traced cos(const Traced& x);
  friend Traced tan(const Traced& x);
  friend Traced sinh(const Traced& x);
  friend Traced cosh(const Traced& x);
  friend Traced tanh(const Traced& x);
  friend Traced atan(const Traced& x);
  friend Traced asin(const Traced& x);
  friend Traced acos(const Traced& x);
  friend Traced abs(const Traced& x);
  friend Traced pow(const Traced& x, double exponent);
  friend Traced raise(const Traced& x, const Traced& exponent);
  friend Traced pow(const Traced& x, const Traced& exponent) { return raise(x, exponent); }
  friend Traced phi1(const Traced& z);

  /// The outcome of a comparison is not known while recording, unless both numbers are constants.
  struct Mask;
  friend Mask operator<(const Traced& a, const Traced& b);
  friend Mask operator>(const Traced& a, const Traced& b);
  friend Mask operator<=(const Traced& a, const Traced& b);
  friend Mask operator>=(const Traced& a, const Traced& b);
  friend Traced select(const Mask& mask, const Traced& yes, const Traced& no);
  /// Nodes never compare as equal, so that code that caches results by their arguments computes them anew.
  friend constexpr bool operator==(const Traced& a, const Traced& b) {
    return a.is_constant() && b.is_constant() && a.constant_ == b.constant_;
  }

 private:
  Traced(Trace& trace, Trace::Place place) : trace_(&trace), place_(place) {}
  static Traced made(LaneCode code, const Traced& a);
  static Traced made(LaneCode code, const Traced& a, const Traced& b);
  static Traced made(LaneCode code, const Traced& a, const Traced& b, const Traced& c);

  Trace* trace_ = nullptr;  ///< null: a constant
  Trace::Place place_ = -1;
  double constant_ = 0;
};

/// Mask is a recorded condition: 1 where it holds, else 0.
struct Traced::Mask {
  Traced on;
  Mask operator!() const { return {1 - on}; }
};
inline bool any(const Traced::Mask& mask) { return !mask.on.is_constant() || mask.on.constant() != 0; }
inline bool all(const Traced::Mask& mask) { return mask.on.is_constant() && mask.on.constant() != 0; }

/// TracedStatus records where a step fails; the step goes on, as its results then do not matter.
struct TracedStatus {
  Traced failed = 0;
  TracedStatus(StepStatus all)  // NOLINT(google-explicit-constructor): one for all
      : failed(all == StepStatus::ok ? 0 : 1) {}
};
inline Traced::Mask succeeded(const TracedStatus&) { return {1}; }
inline bool all_failed(TracedStatus& status, const Traced::Mask& where, StepStatus) {
  status.failed = select(where, Traced(1), status.failed);
  return false;
}
inline bool all_failed(TracedStatus& status, bool where, StepStatus) {
  if (where) status.failed = 1;
  return false;
}
template <>
struct StatusFor<Traced> {
  using type = TracedStatus;
};
template <>
struct Precision<Traced> : Precision<double> {};
template <>
inline Traced parse<Traced>(std::string_view text) {
  return parse<double>(text);
}

}  // namespace least
