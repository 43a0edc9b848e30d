// Expansion is the Taylor series of a motion at one time: `taylor` takes its steps by it, and derivatives of motions
// are followed along it (core/variations). Its sources are those of core/schemes/taylor.hpp.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/schemes/held_program.hpp"
#include "core/tape/series.hpp"
#include "core/tape/steep.hpp"

namespace least::taylor {

/// The series of a motion at one time, and how far it is accurate. It is scratch memory of a thread, which all its
/// steppers of the same equations, tolerance and order share.
class Expansion {
 public:
  static constexpr double allowed = 1.0 / 16;  ///< last terms, in tolerances; the first left out are 1/4 of them

  /// `order` 0 chooses the order with the cheapest steps per unit of time.
  Expansion(tape::Program program, double tolerance, int order);
  /// An expansion whose series is interpreted, so that all values are known at every order.
  static Expansion of_all_values(tape::Program program, double tolerance, int order);

  /// Sets the size of a state below which errors are absolute (least_size); it is 1 before.
  void set_least_size(double size) {
    least_size_ = size;
    if (beside_) beside_->least_size_ = size;
  }
  /// Expands at the state y and the time t, unless the series is there already.
  void move(const double* y, double t);
  /// Returns how long a step from there may be, at most `most`; 0 where the series has no meaning.
  double step(double most = std::numeric_limits<double>::infinity());
  /// Estimates the largest error that rounding within the formulas causes in a step of the length h, close to a place
  /// where a formula is 0/0; 0 where that is less than the error allowed in any case.
  double blur(double h) const { return blur_ * h > may_be_off() ? blur_ * h : 0; }
  /// Returns how far from there the series of components carried beyond the motion are accurate, by their last two
  /// terms.
  double carried_step() const;
  /// Another expansion of the same equations, tolerance and order, for carried components within a step of the motion.
  /// `make_beside` has to be called before.
  Expansion& beside() { return *beside_; }
  void make_beside();
  /// Writes the state at the time h after the expansion point, where it is y, to `end`. `low` is the rounding error
  /// that y carries, and `rest` receives that of the result; the lists may be the same. `room`: the lists have place
  /// for one more number where three follow whole fours.
  void evaluate(double h, const double* y, const double* low, double* end, double* rest, bool room = false) const;
  void evaluate(double h, double* low, double* y, bool room = false) const { evaluate(h, y, low, y, low, room); }
  /// Whether the motion goes on from y, that is, whether its rates are numbers there.
  bool defined(const double* y, double t) {
    return !(series_.program().partial || series_.divides()) || series_.defined(y, t);
  }
  /// Bounds steps so that the series of e^{rate t} is accurate to the tolerance, for a rate that carried components
  /// have of their own.
  void limit(double rate);
  int order() const { return series_.order(); }
  const tape::Program& program() const { return series_.program(); }
  const tape::Series& series() const { return series_; }

 private:
  static constexpr std::size_t places = 4;  ///< places within a step at which it is checked against the equations

  Expansion(Held held, tape::Series series, double tolerance);

  double largest(int k) const;  ///< largest coefficient of the motion, if they are finite
  double size(int k) const;     ///< sum of sizes of coefficients: finite if all are
  double may_be_off() const;
  double largest_carried(int k) const;
  void find_used();
  double length_by_series() const;
  void look_closer(const double* y);
  double until_pole(double h) const;
  bool leave_border(const double* y);
  /// Shortens the step `end` to where the series of all values that choose formulas are accurate, and to shortly behind
  /// the first time at which one of them changes its sign. Returns that time, or nothing.
  std::optional<double> until_switch(double& end);
  double behind_switch(tape::Index value, bool before, double h, double longest);
  template <std::size_t Pairs>
  double series_step() const;
  /// Returns the step h, shortened where a coefficient of an order k, `from` ≥ k ≥ `to`, exceeds `most` ρ^(`from` + 1 −
  /// k).
  double heeded(double h, int from, int to, double most, double rho, double scale) const;
  bool may_hide_what_comes(double h, double most) const;
  bool until_hidden(double& h) const;
  bool until_steep(double& h) const;
  double up_to_number(double h) const;
  double turning(std::size_t i, double h) const;
  bool moves(double h) const;
  bool solves(double h);

  Held held_;  ///< memory of the series
  tape::Series series_;
  double longest_ = std::numeric_limits<double>::infinity();
  double tolerance_, inverse_root_;  ///< ε, and ε^{−1/p} of the order p
  double least_size_ = 1;
  std::size_t variables_, moving_;
  double t_ = std::numeric_limits<double>::quiet_NaN();
  int used_ = 0;                      ///< the order up to which coefficients are used
  double blur_ = 0;                   ///< rounding error of the rates, where it may matter
  double told_ = 0;                   ///< how far coefficients are more than rounding errors
  bool close_ = false;                ///< coefficients were computed in double-double
  bool reads_time_;                   ///< the equations depend on the time
  bool guarded_;                      ///< the equations may change abruptly ahead without a trace in the series
  std::vector<double> way_, slopes_;  ///< states within the step, and slopes of the polynomials there
  std::unique_ptr<Expansion> beside_;
};

}  // namespace least::taylor
