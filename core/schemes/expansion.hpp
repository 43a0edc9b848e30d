// The series of a motion at one time: what `taylor` takes its steps by, and what derivatives of motions follow
// (core/variations). Its sources are those of core/schemes/taylor.hpp.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/schemes/held_program.hpp"
#include "core/tape/series.hpp"
#include "core/tape/steep.hpp"

namespace least::taylor {

/// The series of a motion at one time, and how far it is good. Scratch of a thread: all its steppers of the same
/// equations, tolerance and order share it.
class Expansion {
 public:
  static constexpr double allowed = 1.0 / 16;  ///< of the tolerance the last terms: the first left out are 1/4 of them

  /// Order 0: the one that promises the cheapest steps per unit of time.
  Expansion(tape::Program program, double tolerance, int order);
  /// One whose series is read, so that all its values are known at every order.
  static Expansion of_all_values(tape::Program program, double tolerance, int order);

  /// At the state y at the time t; nothing is done where it is there already.
  void move(const double* y, double t);
  /// How long a step from there may be, `most` at most; 0: the series means nothing.
  double step(double most = std::numeric_limits<double>::infinity());
  /// How much rounding within the formulas makes a step of the length h from there be off at most, about, beside a
  /// place where one is 0/0; 0 where that is less than what a step may be off in any case.
  double blur(double h) const { return blur_ * h > may_be_off() ? blur_ * h : 0; }
  /// How far from there the series of what is carried beyond the motion is good, by its last two terms.
  double carried_step() const;
  /// Another one of the same equations, tolerance and order: for what is carried, within a step of the motion.
  Expansion& beside() { return *beside_; }
  void make_beside();
  /// The state at the time h from there, where it is y, to `end`. `low`: what rounding has kept from y; `rest`: what it
  /// keeps from the result. They may be the same. `room`: they have a place more where three stand behind whole fours.
  void evaluate(double h, const double* y, const double* low, double* end, double* rest, bool room = false) const;
  void evaluate(double h, double* low, double* y, bool room = false) const { evaluate(h, y, low, y, low, room); }
  /// Whether the motion goes on from y.
  bool defined(const double* y, double t) {
    return !(series_.program().partial || series_.divides()) || series_.defined(y, t);
  }
  /// No step is longer than one in which e^{rate t} is told to the tolerance: a rate that what is carried has of its
  /// own.
  void limit(double rate);
  int order() const { return series_.order(); }
  const tape::Program& program() const { return series_.program(); }
  const tape::Series& series() const { return series_; }

 private:
  static constexpr std::size_t places = 4;  ///< of a step at which it is held against the equations

  Expansion(Held held, tape::Series series, double tolerance);

  double largest(int k) const;  ///< of an order that is finite
  double size(int k) const;     ///< of an order, a sum: finite where all of it is
  double may_be_off() const;
  double largest_carried(int k) const;
  void find_used();
  double length_by_series() const;
  void look_closer(const double* y);
  double until_pole(double h) const;
  bool leave_border(const double* y);
  /// Shortens a step up to `end` to what the series tells of all that formulas are chosen by, or to shortly behind the
  /// first time at which one changes, which is then what it returns.
  std::optional<double> until_switch(double& end);
  double behind_switch(tape::Index value, bool before, double h, double longest);
  template <std::size_t Pairs>
  double series_step() const;
  /// A step h, shorter where a coefficient of an order k in `from` ≥ k ≥ `to` exceeds `most` ρ^(`from` + 1 − k).
  double heeded(double h, int from, int to, double most, double rho, double scale) const;
  bool may_hide_what_comes(double h, double most) const;
  bool until_hidden(double& h) const;
  bool until_steep(double& h) const;
  double up_to_number(double h) const;
  double turning(std::size_t i, double h) const;
  bool moves(double h) const;
  bool solves(double h);

  Held held_;  ///< for the series
  tape::Series series_;
  double longest_ = std::numeric_limits<double>::infinity();
  double tolerance_, inverse_root_;  ///< ε, and ε^{−1/p} of the order p
  std::size_t variables_, moving_;
  double t_ = std::numeric_limits<double>::quiet_NaN();
  int used_ = 0;                      ///< the order up to which coefficients are numbers
  double blur_ = 0;                   ///< what rounding changes in the rates, where that may count
  double told_ = 0;                   ///< how far coefficients are not those of rounding
  bool close_ = false;                ///< coefficients were computed to twice the digits
  bool reads_time_;                   ///< the equations do
  bool guarded_;                      ///< what the equations depend on may hide from a series
  std::vector<double> way_, slopes_;  ///< states on the way, and as the polynomials change there
  std::unique_ptr<Expansion> beside_;
};

}  // namespace least::taylor
