// Tangents of steps whose length the scheme chooses by an energy of the run, on components in one contiguous list, by a
// stepper in dual numbers.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/catalogue/sized_energy_level.hpp"
#include "core/catalogue/sized_tangents.hpp"

namespace least {

/// tangents_by_clock returns the tangents by `stepper`, which has begin(x, E₀) and step(x, h) in numbers with a slope,
/// where step writes its length to h. A stepper of a hybrid also has go_on(method of the step before) and
/// active_method().
template <class Stepper>
StepTangents tangents_by_clock(const Request& request, const TangentSpace& space, Stepper stepper, EnergyLevel level) {
  struct Walk {
    Stepper stepper;
    double level;
    std::vector<Slope> state;

    bool step(const RunState& x, [[maybe_unused]] const ActiveMethod& before, const StateNumbers& u, double change,
              ChangeOfStep& to) {
      const std::size_t size = state.size();
      for (std::size_t i = 0; i < size; ++i) state[i] = Slope(i < x.size() ? x[i] : 0, {i < u.size() ? u[i] : 0});
      Slope h;
      stepper.begin(state.data(), Slope(level, {change}));
      if constexpr (requires { stepper.go_on(before); }) stepper.go_on(before);
      if (stepper.step(state.data(), h) != StepStatus::ok) return false;
      to = {{x.t + h.value, StateNumbers(size)}, StateNumbers(size), h.slope[0], {}};
      if constexpr (requires { stepper.active_method(); }) to.course = stepper.active_method();
      for (std::size_t i = 0; i < size; ++i) {
        to.to[i] = state[i].value;
        to.change[i] = state[i].slope[0];
      }
      return true;
    }
  };
  const auto walk = std::make_shared<Walk>(Walk{std::move(stepper), level.value, std::vector<Slope>(space.components)});
  StepTangents tangents;
  if (!request.until_steps) tangents.end = request.end;
  tangents.along = [walk](const RunState& x, const ActiveMethod& before, const StateNumbers& u, double, double change,
                          ChangeOfStep& to) { return walk->step(x, before, u, change, to); };
  tangents.plain = [walk, space](const RunState& x, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
    const std::size_t size = space.components;
    map = {space.dof, x, x, std::vector<double>(size * size)};
    ChangeOfStep found;
    for (std::size_t j = 0; j < size; ++j) {
      StateNumbers u(size);
      u[j] = 1;
      if (!keep_going() || !walk->step(x, {}, u, 0, found)) return false;
      for (std::size_t i = 0; i < size; ++i) map.m[i * size + j] = found.change[i];
    }
    map.to = found.to;
    return true;
  };
  if (space.components > most_mapped) tangents.plain = nullptr;
  tangents.level = std::move(level.slopes);
  return tangents;
}

}  // namespace least
