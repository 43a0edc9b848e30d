#include "core/variations/start.hpp"

#include <algorithm>

namespace least::variations {

tape::Formula formula_of(const ParametricScene& scene, const std::vector<Symbol>& all) {
  tape::Tape tape = scene.tape;  // constants are written
  std::vector<tape::Index> places;
  for (const Symbol& y : all) places.push_back(y.on(tape));
  return {tape, places};
}

Start::Start(const Scene& scene, const SensitivitiesAsked& asked)
    : equations_(*asked.equations), asked_(asked), t_(scene.start), size_(equations_.components) {
  for (const std::size_t place : equations_.variables) x_.push_back(scene.initial[place]);
  std::vector<double> all = x_;
  all.insert(all.end(), equations_.parameters.begin(), equations_.parameters.end());
  rates_.resize(size_);
  formula_of(equations_, equations_.rates).evaluate(all.data(), t_, rates_.data());
  if (!asked.keeps_velocities) return;
  momenta_ = formula_of(equations_, equations_.momenta);
  const std::size_t n = equations_.coordinates;
  std::copy_n(rates_.begin(), n, all.begin() + static_cast<std::ptrdiff_t>(n));
  in_velocities_ = std::move(all);
}

std::vector<double> Start::slope(const Quantity& by) const {
  std::vector<double> slope = asked_.keeps_velocities ? slope_in_velocities(by) : slope_in_momenta(by);
  if (by.kind != Quantity::Kind::time) return slope;
  for (std::size_t i = 0; i < size_; ++i)  // what starts later has not come as far
    slope[i] = equations_.sign_of_time() * (slope[i] - rates_[i]);
  return slope;
}

double Start::value(const Quantity& by) const {
  if (by.kind == Quantity::Kind::parameter) return equations_.parameters[by.index];
  if (by.kind == Quantity::Kind::velocity) return in_velocities_[equations_.coordinates + by.index];
  const auto found = std::ranges::find(equations_.variables, by.index);
  return found == equations_.variables.end() ? 0 : x_[static_cast<std::size_t>(found - equations_.variables.begin())];
}

void Start::move(const Quantity& quantity, double by, Scene& scene) const {
  const bool parameter = quantity.kind == Quantity::Kind::parameter;
  if (parameter) scene.parameters[quantity.index] += by;
  const std::size_t n = equations_.coordinates;
  if (!asked_.keeps_velocities) {
    const std::vector<double> slope = slope_in_momenta(quantity);
    for (std::size_t i = 0; i < size_; ++i) scene.initial[equations_.variables[i]] += slope[i] * by;
    return;
  }
  std::vector<double> x = in_velocities_, momenta(n);
  const std::vector<double> slope = slope_in_momenta(quantity);
  for (std::size_t i = 0; i < size_; ++i) x[i] += slope[i] * by;
  if (parameter) x[size_ + quantity.index] += by;
  if (quantity.kind == Quantity::Kind::velocity) x[n + quantity.index] += equations_.signs[n + quantity.index] * by;
  momenta_.evaluate(x.data(), t_, momenta.data());
  for (std::size_t i = 0; i < size_; ++i)
    scene.initial[equations_.variables[i]] = i < n || i == 2 * n ? x[i] : momenta[i - n];
}

std::vector<double> Start::slope_in_momenta(const Quantity& by) const {
  std::vector<double> slope(size_);
  if (by.kind != Quantity::Kind::variable) return slope;
  const auto found = std::ranges::find(equations_.variables, by.index);
  if (found == equations_.variables.end()) return slope;  // s, which the motion does not need
  const auto i = static_cast<std::size_t>(found - equations_.variables.begin());
  slope[i] = equations_.signs[i];
  return slope;
}

/// The coordinate, the velocity, the parameter or the time changes, and the momenta follow.
std::vector<double> Start::slope_in_velocities(const Quantity& by) const {
  const std::size_t n = equations_.coordinates;
  std::vector<double> slope = slope_in_momenta(by);
  std::vector<Slope> x(in_velocities_.begin(), in_velocities_.end()), momenta(n);
  Slope t = t_;
  for (std::size_t i = 0; i < size_; ++i) x[i].slope[0] = slope[i];
  if (by.kind == Quantity::Kind::velocity) x[n + by.index].slope[0] = equations_.signs[n + by.index];
  if (by.kind == Quantity::Kind::parameter) x[size_ + by.index].slope[0] = 1;
  if (by.kind == Quantity::Kind::time) t.slope[0] = 1;
  momenta_.evaluate(x.data(), t, momenta.data());
  for (std::size_t i = 0; i < n; ++i) slope[n + i] = momenta[i].slope[0];
  return slope;
}

}  // namespace least::variations
