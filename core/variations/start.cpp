#include "core/variations/start.hpp"

#include <algorithm>

namespace least::variations {

tape::Formula formula_of(const ParametricScene& scene, const std::vector<Symbol>& all) {
  tape::Tape tape = scene.tape;  // a copy, as constants may have to be added
  std::vector<tape::Index> places;
  places.reserve(all.size());
  for (const Symbol& y : all) places.push_back(y.on(tape));
  return {tape, places};
}

Start::Start(const Scene& scene, const SensitivitiesAsked& asked)
    : equations_(*asked.equations), asked_(asked), scene_(scene), t_(scene.start), size_(equations_.components) {
  for (const std::size_t place : equations_.variables) x_.push_back(scene.initial[place]);
  regular_ = t_ != 0 && regular(scene.parameters) == x_;
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
  if (regular_ && by.kind == Quantity::Kind::parameter) return slope_of_regular(by.index, 1);
  std::vector<double> slope = asked_.keeps_velocities ? slope_in_velocities(by) : slope_in_momenta(by);
  if (by.kind != Quantity::Kind::time) return slope;
  if (regular_) return std::vector<double>(size_);  // the start moves along with the motion
  for (std::size_t i = 0; i < size_; ++i)  // the later the start, the less the motion has advanced at a given time
    slope[i] = equations_.sign_of_time() * (slope[i] - rates_[i]);
  return slope;
}

double Start::value(const Quantity& by) const {
  if (by.kind == Quantity::Kind::parameter) return equations_.parameters[by.index];
  if (by.kind == Quantity::Kind::time) return equations_.sign_of_time() * t_;
  if (by.kind == Quantity::Kind::velocity) return in_velocities_[equations_.coordinates + by.index];
  const auto found = std::ranges::find(equations_.variables, by.index);
  return found == equations_.variables.end() ? 0 : x_[static_cast<std::size_t>(found - equations_.variables.begin())];
}

void Start::move(const Quantity& quantity, double by, Scene& scene) const {
  const bool parameter = quantity.kind == Quantity::Kind::parameter;
  if (parameter) scene.parameters[quantity.index] += by;
  if (quantity.kind == Quantity::Kind::time) scene.start += equations_.sign_of_time() * by;
  const std::size_t n = equations_.coordinates;
  if (regular_ && parameter) {
    const std::vector<double> there = regular(scene.parameters);
    for (std::size_t i = 0; i < size_; ++i) scene.initial[equations_.variables[i]] = there[i];
    return;
  }
  if (!asked_.keeps_velocities) {
    const std::vector<double> slope = slope_in_momenta(quantity);
    for (std::size_t i = 0; i < size_; ++i) scene.initial[equations_.variables[i]] += slope[i] * by;
    return;
  }
  std::vector<double> x = in_velocities_;
  const std::vector<double> way = way_of(quantity);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += way[i] * by;
  const std::vector<double> momenta = momenta_of(x, scene.start);
  for (std::size_t i = 0; i < size_; ++i)
    scene.initial[equations_.variables[i]] = i < n || i == 2 * n ? x[i] : momenta[i - n];
}

std::vector<double> Start::slope_in_momenta(const Quantity& by) const {
  std::vector<double> slope(size_);
  if (by.kind != Quantity::Kind::variable) return slope;
  const auto found = std::ranges::find(equations_.variables, by.index);
  if (found == equations_.variables.end()) return slope;  // s, which is no component where the motion does not need it
  const auto i = static_cast<std::size_t>(found - equations_.variables.begin());
  slope[i] = equations_.signs[i];
  return slope;
}

template <class T>
std::vector<T> Start::momenta_of(std::vector<T> x, const T& t) const {
  std::vector<T> momenta(equations_.coordinates);
  momenta_.evaluate(x.data(), t, momenta.data());
  return momenta;
}

std::vector<double> Start::way_of(const Quantity& by) const {
  std::vector<double> way = slope_in_momenta(by);
  way.resize(in_velocities_.size());
  const std::size_t velocity = equations_.coordinates + by.index;
  if (by.kind == Quantity::Kind::velocity) way[velocity] = equations_.signs[velocity];
  if (by.kind == Quantity::Kind::parameter) way[size_ + by.index] = 1;
  return way;
}

/// slope_in_velocities: the quantity changes at fixed velocities, and the momenta follow from these.
std::vector<double> Start::slope_in_velocities(const Quantity& by) const {
  std::vector<double> slope = slope_in_momenta(by);
  const std::vector<double> way = way_of(by);
  std::vector<Slope> x(in_velocities_.begin(), in_velocities_.end());
  for (std::size_t i = 0; i < x.size(); ++i) x[i].slope[0] = way[i];
  const auto momenta = momenta_of(std::move(x), Slope{t_, {by.kind == Quantity::Kind::time ? 1.0 : 0.0}});
  for (std::size_t i = 0; i < momenta.size(); ++i) slope[momenta.size() + i] = momenta[i].slope[0];
  return slope;
}

std::vector<double> Start::regular(const std::vector<double>& parameters) const {
  std::vector<double> all;
  const auto start = scene_.mechanics->regular_start(parameters, t_);
  if (start && start->objection.empty())
    for (const std::size_t place : equations_.variables) all.push_back(start->state[place]);
  return all;
}

std::vector<double> Start::slope_of_regular(std::size_t parameter, int order) const {
  // The start is a power series with small derivatives: errors are some 1e-12
  const double h = order == 1 ? 1e-3 : 1e-2;
  std::vector<double> parameters = scene_.parameters, slope(size_);
  parameters[parameter] = scene_.parameters[parameter] + h;
  const std::vector<double> after = regular(parameters);
  parameters[parameter] = scene_.parameters[parameter] - h;
  const std::vector<double> before = regular(parameters);
  for (std::size_t i = 0; i < size_; ++i)
    slope[i] = order == 1 ? (after[i] - before[i]) / (2 * h) : (after[i] - 2 * x_[i] + before[i]) / (h * h);
  return slope;
}

std::vector<double> Start::second(const Quantity& a, const Quantity& b) const {
  std::vector<double> second(size_);
  if (regular_ && a.kind == Quantity::Kind::parameter && b.kind == a.kind && a.index == b.index)
    return slope_of_regular(a.index, 2);
  if (!asked_.keeps_velocities) return second;
  const std::vector<double> first = way_of(a), other = way_of(b);
  std::vector<Dual<Slope, 1>> x;
  for (std::size_t i = 0; i < in_velocities_.size(); ++i)
    x.push_back({Slope{in_velocities_[i], {first[i]}}, {Slope(other[i])}});
  const auto momenta = momenta_of(std::move(x), Dual<Slope, 1>(t_));
  for (std::size_t i = 0; i < momenta.size(); ++i) second[momenta.size() + i] = momenta[i].slope[0].slope[0];
  return second;
}

}  // namespace least::variations
