// A step of lifted_splitting on a scene whose size is known when it runs, on components that stand where its caller has
// them. Compiled once, for numbers with and without a slope: core/schemes/lifted_map.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "core/composition.hpp"
#include "core/problem_traits.hpp"

namespace least {

namespace text {
class Lift;
}

/// How the lifted motion q̇ = X, ṡ = g is followed, with the exact derivative of what is done.
enum class LiftMethod : std::uint8_t {
  automatic,     ///< exact where that can be, else midpoint
  exact,         ///< by the matrix exponential, of linear motions with constant coefficients
  midpoint,      ///< the implicit midpoint rule for q and s alone: symmetric, so that every composition keeps its order
  extrapolation  ///< the explicit midpoint rule, extrapolated to the order of the composition: nothing is solved for
};
inline constexpr std::array<std::string_view, 4> lift_names{"automatic", "exact", "midpoint", "extrapolation"};

/// Strang's splitting of S and the lift, composed. A value; copies share what does not depend on a state and room for
/// what a step writes down on its way, so that they belong to one thread.
template <class T>
class LiftedMap {
 public:
  /// Without a lift no step succeeds.
  LiftedMap(std::shared_ptr<const text::Lift> lift, const Composition& composition, LiftMethod method);

  /// n coordinates and momenta; s where the motion reads it, else null; ∇V and V at that place and time, n + 1 numbers
  /// that `begin` writes and steps keep.
  struct Place {
    T *q, *p, *s, *slope;
  };
  void begin(const T* q, double t, T* slope);
  /// From the time t on. One that fails leaves the state somewhere on its way. Singular: the lifted motion turns the
  /// contact elements over, so that p has a pole.
  StepStatus step(const Place& x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  class Steps;

  std::shared_ptr<Steps> steps_;
  Work work_;
};

extern template class LiftedMap<double>;
extern template class LiftedMap<Slope>;

}  // namespace least
