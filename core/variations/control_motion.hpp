// The control of steps that lie ready (core/variations/steps_ahead.hpp): a second motion with a direction u of its
// derivatives, by series of a higher order and with rounding errors of its own. It stays so near to the first that it
// is known by its differences, e of the state and v of the direction, and that these need the matrices C of the first
// motion only to lead what is no larger than they are. Thus steps of the control, too, are found side by side: they
// begin at X near y + e and U near u + v, before it is known where the last one ends, and
//   e⁺ = e + C (e − a) + (P′ − P), v⁺ = v + C (v − b) + (Q′ − C u), a = X − y, b = U − u,
// where the first motion changes by P and C u in a step, and that of the control from X and U by P′ and Q′. X and U
// are perturbed at random by a rounding, because two computations from equal numbers would make equal rounding errors,
// which their difference could not show.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/tape/step_tangents.hpp"

namespace least::variations {

class ControlMotion {
 public:
  /// A step of the first motion: its place among those that lie ready, its matrix, and the state, with what rounding
  /// has kept from it, where it begins and where it ends.
  struct Step {
    std::size_t place;
    const double* matrix;
    std::span<const double> from, low_from, to, low_to;
  };

  /// `varied` as StepsAhead has it; the order of the series.
  ControlMotion(tape::Program varied, int order);
  static std::size_t numbers(const tape::Program& varied);

  /// At the start of the first motion, along a direction of all variables.
  void start(std::vector<double> direction);
  /// Prepares steps for those of the first motion that lie ready, which begin and are as long as told.
  void prepare(std::span<const double> begins, std::span<const double> times, std::span<const double> lengths,
               const tape::StepTangents& matrices);
  /// Such a step has been taken.
  void take(const Step& step);
  /// Or only the time h of it, after which others are prepared.
  void take_part(const Step& step, double h);
  /// The direction as the control has it in the time h of a step.
  std::vector<double> look(const Step& step, double h);

 private:
  /// The first motion's direction, with what rounding has kept from it, and the differences.
  struct Place {
    std::vector<double> u, low, e, v;
  };
  static constexpr std::size_t lanes = 4;
  void rescale();
  double perturbed(double x);
  void multiply(const double* matrix);
  void move(const Step& step, const double* change, Place& to);

  tape::StepTangents tangents_;
  std::size_t columns_, size_;
  int exponent_ = 0;  ///< of two: by what all directions have been divided
  std::uint64_t random_ = 0;
  Place here_, there_;
  std::vector<double> begins_, directions_;  ///< X and U of each step
  std::vector<double> fours_, product_;      ///< by variable what is multiplied, side by side
  std::vector<double> change_;
};

}  // namespace least::variations
