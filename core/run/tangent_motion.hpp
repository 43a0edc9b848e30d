// A motion and its derivatives along several directions of its start, by the Taylor series of its equations and of
// their variational equations u̇ = (∂f/∂x) u, which are derived on the tape. Derivatives are rescaled at each step, so
// that they have as many digits as the motion itself, however far they grow or shrink. Source: Barrio, SIAM J. Sci.
// Comput. 27, 1929 (2006).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/schemes/taylor.hpp"

namespace least {

/// TangentMotion can be copied; copies share the series, which each recomputes when it needs it.
class TangentMotion {
 public:
  /// `rates` are the rates ẋ of the variables on the tape of equations, in order; `directions` is the number of
  /// directions. Throws TooManyOperations if the derivatives take more operations than the largest scene may have.
  TangentMotion(tape::Tape equations, std::span<const tape::Index> rates, std::size_t directions, double tolerance);

  /// `tangents`: the directions at the start, one after the other, size of x each.
  void start(std::span<const double> x, std::span<const double> tangents, double t);
  double time() const { return t_; }
  /// The largest length of the next step; 0: there is none.
  double step();
  /// look evaluates the motion at the time `ahead` after the last step, within the next; state() and tangent() then
  /// refer to it. False: it is not finite there.
  bool look(double ahead);
  /// move ends the step at the time t of the last look. False: the equations are undefined there.
  bool move(double t);

  std::span<const double> state() const { return std::span(seen_).first(size_); }
  /// A derivative without its factor 2ⁿ, n = exponent(direction).
  std::span<const double> tangent(std::size_t direction) const {
    return std::span(seen_).subspan((1 + direction) * size_, size_);
  }
  int exponent(std::size_t direction) const { return exponents_[direction]; }
  /// The largest component of all derivatives, times the largest component at the start.
  double growth() const;
  /// Whether the equations are linear in all variables and contain no division.
  bool linear() const { return expansion_->program().whole; }
  /// About the number of operations of one order of the series.
  std::size_t operations() const;
  /// The derivative of one component along one of the directions.
  double derivative(std::size_t component, std::size_t direction) const;

 private:
  static tape::Program program_of(tape::Tape equations, std::span<const tape::Index> rates, std::size_t directions);
  void rescale();

  std::size_t size_, directions_;  ///< number of components, and of directions
  std::shared_ptr<taylor::Expansion> expansion_;
  double t_ = 0, scale_ = 0;
  std::vector<double> y_, seen_, low_;  ///< the state, then its derivatives along each direction
  std::vector<int> exponents_;          ///< the powers of 2 that the derivatives along a direction have been divided by
};

}  // namespace least
