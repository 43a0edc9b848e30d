// Tangent maps of steps whose scheme, problem and length are known at compile time, and their defects of structure.
#pragma once

#include <array>
#include <optional>

#include "core/run/tangent.hpp"

namespace least {

template <class Scheme, class P, class X>
std::optional<Tangent<X>> tangent_map(const Scheme& scheme, const P& problem, const X& x, double h) {
  const auto always = [] { return true; };
  return tangent_of(x, always, [&](auto& y) {
    auto stepper = scheme.bind(problem, y);
    const StepStatus status = stepper.step(y, h);
    y.t = x.t + h;
    return status;
  });
}

template <std::size_t M>
double symplectic_defect(const std::array<std::array<double, M>, M>& m) {
  TangentMap map;
  map.dof = M / 2;
  map.from.numbers.resize(M);
  for (const auto& row : m) map.m.insert(map.m.end(), row.begin(), row.end());
  return symplectic_defect(map);
}
template <class X>
ContactDefect contact_defect(const X& x, const Tangent<X>& tangent) {
  return contact_defect(tangent_map(x, tangent));
}

}  // namespace least
