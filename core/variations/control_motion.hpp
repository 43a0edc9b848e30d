// The error control of precomputed steps (core/variations/steps_ahead.hpp): a second motion with one direction u of its
// derivatives, by series of a higher order and with rounding errors of its own. It stays so close to the first motion
// that it is kept as differences, e of the state and v of the direction. The matrices C of the first motion transport
// these differences only, whose errors do not matter. Hence steps of the control, too, can be computed side by side:
// they begin at X near y + e and U near u + v, before the end of the previous step is known, and
//   e⁺ = e + C (e − a) + (P′ − P), v⁺ = v + C (v − b) + (Q′ − C u), a = X − y, b = U − u,
// where a step changes the first motion by P and C u, and that of the control, from X and U, by P′ and Q′. X and U are
// perturbed at random in the last place, because two computations from equal numbers would make equal rounding errors,
// which their difference could not show.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/tape/step_tangents.hpp"

namespace least::variations {

/// ControlMotion follows one control beside the steps of a StepsAhead. A step changes the variables y, of which the
/// first `moving` ones move and the others are parameters, by the matrix C (moving × columns, row-major).
class ControlMotion {
 public:
  /// Step is a step of the first motion: its index among the precomputed steps, its matrix C, and the states at its
  /// ends. `low` parts are compensations: what rounding has lost from the state.
  struct Step {
    std::size_t place;
    const double* matrix;
    std::span<const double> from, low_from, to, low_to;
  };

  /// `varied` is the program of StepsAhead; `order` that of the control's series.
  ControlMotion(tape::Program varied, int order);
  /// numbers(varied) returns about how many doubles a control needs.
  static std::size_t numbers(const tape::Program& varied);

  /// start(u) begins at the start of the first motion, with the direction u of all variables.
  void start(std::vector<double> direction);
  /// prepare computes the control's part of all precomputed steps from their beginnings (columns numbers each), times
  /// and lengths.
  void prepare(std::span<const double> begins, std::span<const double> times, std::span<const double> lengths,
               const tape::StepTangents& matrices);
  /// take(step) moves the control to the end of that step.
  void take(const Step& step);
  /// take_part(step, h) moves it by the time h < length only; other steps must be prepared then.
  void take_part(const Step& step, double h);
  /// look(step, h) returns the control's direction (the `moving` components) after the time h of a step.
  std::vector<double> look(const Step& step, double h);

 private:
  /// Place is the first motion's direction u with its compensation, and the differences e and v.
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
  int exponent_ = 0;  ///< all directions are stored divided by 2^exponent_
  std::uint64_t random_ = 0;
  Place here_, there_;
  std::vector<double> begins_, directions_;  ///< X and U by step, columns numbers each
  /// Four columns to be multiplied by C, interleaved by variable, and their products
  std::vector<double> fours_, product_;
  std::vector<double> change_;
};

}  // namespace least::variations
