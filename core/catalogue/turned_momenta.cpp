#include "core/catalogue/turned_momenta.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/tape/derivative.hpp"

namespace least {
namespace {

/// sums_of_momenta returns the conditions of choices between formulas as far as they are linear combinations of momenta
/// with constant coefficients, each once up to a factor: one row of coefficients each. Empty if a condition depends on
/// momenta in another way.
std::optional<std::vector<std::vector<double>>> sums_of_momenta(const text::SizedScene& scene) {
  const std::size_t n = scene.coordinates;
  tape::Tape tape = scene.equations;
  std::vector<std::vector<double>> all;
  std::size_t left = text::most_looked_at;
  tape::Dependences others(tape, [n](int i) { return tape::Dependence(static_cast<std::size_t>(i) < n ? 1 : 0); });
  for (tape::Index i = 0, size = tape.size(); i < size; ++i) {
    if (tape[i].op != tape::Op::select) continue;
    const Symbol by = Symbol::at(tape, tape[i].a);
    std::vector<double> row(n, 0);
    for (const auto& [j, slope] : tape::slopes_of(tape, by, static_cast<int>(n), n, left)) {
      if (!slope.is_constant() || others(by) != 0) return std::nullopt;
      row[j] = slope.constant();
    }
    const double largest = std::abs(*std::ranges::max_element(row, {}, [](double x) { return std::abs(x); }));
    if (largest == 0) continue;
    const auto first = std::ranges::find_if(row, [](double x) { return x != 0; });
    const double by_first = std::copysign(largest, *first);
    for (double& share : row) share /= by_first;
    if (std::ranges::find(all, row) == all.end()) all.push_back(std::move(row));
  }
  return all;
}

}  // namespace

void multiply(const std::vector<double>& matrix, const double* a, double* b) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = 0;
    for (std::size_t j = 0; j < n; ++j) b[i] += matrix[i * n + j] * a[j];
  }
}

std::shared_ptr<const TurnedMomenta> TurnedMomenta::of(const text::SizedScene& scene) try {
  const auto& forces = scene.forces;
  if (!forces.jumps || forces.jumps_alone || !forces.solvable() || scene.has_full_mass()) return nullptr;
  const std::size_t n = scene.coordinates;
  const auto found = sums_of_momenta(scene);
  if (!found || found->size() > n) return nullptr;
  constexpr double rounding = 1e-12;
  const auto across = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i] / scene.inverse_mass()[i];
    return sum;
  };
  std::vector<std::vector<double>> rows;
  for (const auto& row : *found) {
    for (const auto& other : rows)
      if (std::abs(across(row, other)) > rounding * std::sqrt(across(row, row) * across(other, other))) return nullptr;
    rows.push_back(row);
  }
  for (std::size_t i = 0; i < n && rows.size() < n; ++i) {
    std::vector<double> row(n, 0);
    row[i] = 1;
    for (const auto& other : rows) {
      const double share = across(row, other) / across(other, other);
      for (std::size_t j = 0; j < n; ++j) row[j] -= share * other[j];
    }
    constexpr double left = 1e-6;
    if (across(row, row) > left / scene.inverse_mass()[i]) rows.push_back(row);
  }
  if (rows.size() < n) return nullptr;
  auto made = std::make_shared<TurnedMomenta>();
  made->back.resize(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    const double mass = across(rows[i], rows[i]);
    made->inverse_mass.push_back(1 / mass);
    made->jumping.push_back(i < found->size());
    made->to.insert(made->to.end(), rows[i].begin(), rows[i].end());
    for (std::size_t j = 0; j < n; ++j) made->back[j * n + i] = rows[i][j] / (scene.inverse_mass()[j] * mass);
  }
  // A jump has to be along the momentum with which it jumps: compare both sides at an arbitrary state.
  std::vector<double> y(n), state(2 * n), sides[2];
  for (std::size_t which = 0; which < found->size(); ++which) {
    for (std::vector<double>& side : sides) {
      const double sign = &side == &sides[0] ? 1 : -1;
      for (std::size_t i = 0; i < n; ++i) {
        state[i] = 0.3 + 0.1 * static_cast<double>(i);
        y[i] = i == which ? sign * rounding : 1 + 0.2 * static_cast<double>(i);
      }
      multiply(made->back, y.data(), state.data() + n);
      std::vector<double> force(n);
      scene.forces.values.evaluate(state.data(), 0.7, force.data());
      side.resize(n);
      multiply(made->to, force.data(), side.data());
    }
    constexpr double same = 1e-9;
    for (std::size_t i = 0; i < n; ++i)
      if (i != which && !(std::abs(sides[0][i] - sides[1][i]) <= same)) return nullptr;
  }
  return made;
} catch (const tape::TooManyOperations&) {
  return nullptr;
}

bool knows_rest(const text::SizedScene& scene) {
  return scene.forces.can_rest() || TurnedMomenta::of(scene) != nullptr;
}

}  // namespace least
