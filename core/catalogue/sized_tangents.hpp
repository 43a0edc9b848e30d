// Tangents of steps of equal length on components in one contiguous list, by a stepper in dual numbers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "core/number/dual.hpp"
#include "core/run/request.hpp"
#include "core/run/tangent_map.hpp"

namespace least {

/// The largest number of components for which all directions are followed at once: work with their matrix is cubic in
/// it.
inline constexpr std::size_t most_mapped = 256;

/// TangentSpace is the space that tangents belong to.
struct TangentSpace {
  std::size_t dof = 0;         ///< degrees of freedom; 0 for a flow
  std::size_t components = 0;  ///< components of the full state: q, p, and s if there is one
};

/// tangents_by returns the tangents of steps of length `step` by `stepper`, which has begin(x, t) and step(x, t, h) in
/// numbers with a slope, or begin(x, t, start) if its steps depend on the start of the run. States of a run may have
/// fewer components than the space: the others are 0.
template <class Stepper>
StepTangents tangents_by(const Request& request, const TangentSpace& space, double step, Stepper stepper) {
  struct Walk {
    Stepper stepper;
    std::vector<Slope> start, state;

    bool along(const RunState& x, const StateNumbers& u, double h) {
      for (std::size_t i = 0; i < state.size(); ++i)
        state[i] = Slope(i < x.size() ? x[i] : 0, {i < u.size() ? u[i] : 0});
      if constexpr (requires { stepper.begin(state.data(), x.t, start.data()); }) {
        stepper.begin(state.data(), x.t, start.data());
      } else {
        stepper.begin(state.data(), x.t);
      }
      return stepper.step(state.data(), x.t, h) == StepStatus::ok;
    }
  };
  const auto& initial = request.scene->initial;
  const auto walk = std::make_shared<Walk>(Walk{std::move(stepper), {initial.begin(), initial.end()}, {}});
  walk->start.resize(space.components);
  walk->state.resize(space.components);
  StepTangents tangents;
  if (!request.until_steps) tangents.end = request.end;
  tangents.along = [walk, step](const RunState& x, const ActiveMethod&, const StateNumbers& u, double, double,
                                ChangeOfStep& to) {
    if (!walk->along(x, u, step)) return false;
    const std::size_t size = walk->state.size();
    to = {{x.t + step, StateNumbers(size)}, StateNumbers(size)};
    for (std::size_t i = 0; i < size; ++i) {
      to.to[i] = walk->state[i].value;
      to.change[i] = walk->state[i].slope[0];
    }
    return true;
  };
  tangents.plain = [walk, step, space](const RunState& x, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
    const std::size_t size = space.components;
    map = {space.dof, {x.t, StateNumbers(size)}, {x.t + step, StateNumbers(size)}, std::vector<double>(size * size)};
    for (std::size_t i = 0; i < std::min(size, x.size()); ++i) map.from[i] = x[i];
    for (std::size_t j = 0; j < size; ++j) {
      StateNumbers u(size);
      u[j] = 1;
      if (!keep_going() || !walk->along(x, u, step)) return false;
      for (std::size_t i = 0; i < size; ++i) {
        map.to[i] = walk->state[i].value;
        map.m[i * size + j] = walk->state[i].slope[0];
      }
    }
    return true;
  };
  if (space.components > most_mapped) tangents.plain = nullptr;
  tangents.level.assign(space.components, 0);
  return tangents;
}

}  // namespace least
