// LiftedMap takes steps of lifted_splitting on a scene whose size is known at run time, in place on its caller's
// components. It is compiled once, for numbers with and without a slope (core/schemes/lifted_map.cpp).
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

/// The method for the lifted motion q̇ = X, ṡ = g, whose exact derivative moves the momenta.
enum class LiftMethod : std::uint8_t {
  automatic,     ///< exact where that can be, else midpoint
  exact,         ///< by the matrix exponential, of linear motions with constant coefficients
  midpoint,      ///< the implicit midpoint rule for q and s alone: symmetric, so that every composition keeps its order
  extrapolation  ///< the explicit midpoint rule, extrapolated to the order of the composition, without equations to
                 ///< solve
};
inline constexpr std::array<std::string_view, 4> lift_names{"automatic", "exact", "midpoint", "extrapolation"};

/// Strang's splitting of S and the lift, composed. Copies share scratch memory and what does not depend on a state, so
/// all of them belong to one thread.
template <class T>
class LiftedMap {
 public:
  /// Without a lift no step succeeds.
  LiftedMap(std::shared_ptr<const text::Lift> lift, const Composition& composition, LiftMethod method);

  /// Place points to a state: n coordinates and momenta; s, or null where the motion does not read it; and ∇V and V at
  /// that place and time, n + 1 numbers that `begin` writes and steps update.
  struct Place {
    T *q, *p, *s, *slope;
  };
  void begin(const T* q, double t, T* slope);
  /// Moves x by a step of the length h from the time t. A step that fails leaves an intermediate state. It is singular
  /// where the lifted motion turns the contact elements over, so that p has a pole.
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
