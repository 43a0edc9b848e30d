// A motion and its derivatives in directions of its start, all at once, by the Taylor series of its equations and of
// their variational equations u̇ = (∂f/∂x) u, which are derived on the tape. Derivatives are rescaled from step to step,
// so that they have as many digits as the motion itself, however far they grow or shrink.
// Source: Barrio, SIAM J. Sci. Comput. 27, 1929 (2006).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/schemes/taylor.hpp"

namespace least {

/// A value; copies share the series, which any of them makes anew where it needs it.
class TangentMotion {
 public:
  /// Of the tape of equations the rates ẋ of the variables, in their order, and how many directions are followed.
  /// Throws TooManyOperations where the derivatives take more than the largest scene may.
  TangentMotion(tape::Tape equations, std::span<const tape::Index> rates, std::size_t directions, double tolerance);

  /// `tangents`: the directions, one after the other.
  void start(std::span<const double> x, std::span<const double> tangents, double t);
  double time() const { return t_; }
  /// How long the next step may be; 0: there is none.
  double step();
  /// What is seen becomes the motion at this time after the last step, within the next. False: it is not finite there.
  bool look(double ahead);
  /// A step, as long as the last look went ahead, to the time t. False: the equations mean nothing there.
  bool move(double t);

  std::span<const double> state() const { return std::span(seen_).first(size_); }
  /// A derivative, but for a factor 2ⁿ, n = exponent(direction).
  std::span<const double> tangent(std::size_t direction) const {
    return std::span(seen_).subspan((1 + direction) * size_, size_);
  }
  int exponent(std::size_t direction) const { return exponents_[direction]; }
  /// The largest of all derivatives, times the largest component at the start.
  double growth() const;
  /// Whether the equations are linear in all variables and nothing is divided.
  bool linear() const { return expansion_->program().whole; }
  /// About how many operations one order of the series takes.
  std::size_t operations() const;
  /// Of one component, in one of the directions.
  double derivative(std::size_t component, std::size_t direction) const;

 private:
  static tape::Program program_of(tape::Tape equations, std::span<const tape::Index> rates, std::size_t directions);
  void rescale();

  std::size_t size_, directions_;  ///< of the state; how many
  std::shared_ptr<taylor::Expansion> expansion_;
  double t_ = 0, scale_ = 0;
  std::vector<double> y_, seen_, low_;  ///< the state, then its derivatives, one after the other
  std::vector<int> exponents_;          ///< of two: by what those of a direction have been divided
};

}  // namespace least
