#include "core/periodic/conserved.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/tape/derivative.hpp"

namespace least::periodic {
namespace {

constexpr std::size_t most_quadratic = 24;  // components up to which products are tested

/// monomials lists the monomials x_i x_j as pairs (i, j), and x_j as (none, j).
constexpr std::size_t none = static_cast<std::size_t>(-1);
std::vector<std::pair<std::size_t, std::size_t>> monomials(std::size_t size) {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  all.reserve(size + size * (size + 1) / 2);
  for (std::size_t i = 0; i < size; ++i) all.emplace_back(none, i);
  if (size > most_quadratic) return all;
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = i; j < size; ++j) all.emplace_back(i, j);
  return all;
}

/// add_slope adds the gradient of coefficient × monomial at y.
void add_slope(const std::pair<std::size_t, std::size_t>& monomial, double coefficient, std::span<const double> y,
               std::vector<double>& gradient) {
  const auto [i, j] = monomial;
  if (i == none) {
    gradient[j] += coefficient;
  } else {
    gradient[i] += coefficient * y[j];
    gradient[j] += coefficient * y[i];
  }
}

/// sizes_of returns the lengths of columns; 1 for columns of length 0.
std::vector<double> sizes_of(const Matrix& columns) {
  std::vector<double> sizes(columns.columns);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    sizes[k] = length(columns.column(k));
    if (!(sizes[k] > 0) || !std::isfinite(sizes[k])) sizes[k] = 1;
  }
  return sizes;
}

Matrix divided(Matrix columns, const std::vector<double>& by) {
  for (std::size_t i = 0; i < columns.rows; ++i)
    for (std::size_t k = 0; k < columns.columns; ++k) columns(i, k) /= by[k];
  return columns;
}

bool all_finite(std::span<const double> x) {
  return std::ranges::all_of(x, [](double value) { return std::isfinite(value); });
}

}  // namespace

Conserved::Conserved(const Motion& motion, const Scene& scene, std::span<const double> x,
                     std::span<const double> extents, double t, double dt)
    : motion_(motion), center_(x.begin(), x.end()), extents_(extents.begin(), extents.end()), start_(t) {
  energy_kept_ = motion.autonomous() && keeps_energy(t);
  if (!motion.equations().form->invariants.empty()) read_declared(scene, t);
  find(t, dt);
  find_decaying(t, dt);
  find_felt(t);
  gradient_sizes_ = sizes_of(raw_gradients(x, t));
  symmetry_sizes_ = sizes_of(raw_symmetries(x, t));
}

Matrix Conserved::gradients(std::span<const double> x, double t) const {
  return divided(raw_gradients(x, t), gradient_sizes_);
}
Matrix Conserved::symmetries(std::span<const double> x, double t) const {
  return divided(raw_symmetries(x, t), symmetry_sizes_);
}

/// read_declared rewrites the declared invariants, whose tape has the form's numbering, for components and with numbers
/// for parameters.
void Conserved::read_declared(const Scene& scene, double t) {
  const variations::ParametricScene& equations = motion_.equations();
  const text::Form& form = *equations.form;
  const text::Numbering& numbers = form.numbers;
  const auto n = static_cast<int>(equations.coordinates), size = static_cast<int>(equations.components);
  tape::Tape tape;
  tape::Substitution rewrite(form.tape, tape, [&](int i) {
    if (i >= numbers.parameter) return Symbol(scene.parameters[static_cast<std::size_t>(i - numbers.parameter)]);
    int place = n == 0 || i < numbers.momentum ? i : n + i - numbers.momentum;
    if (n > 0 && i == numbers.action) place = 2 * n;
    return place < size ? Symbol::variable(tape, static_cast<std::size_t>(place)) : Symbol(0);
  });
  std::vector<int> all(equations.components);
  std::iota(all.begin(), all.end(), 0);
  std::vector<tape::Index> values, slopes;
  values.reserve(form.invariants.size());
  slopes.reserve(form.invariants.size() * all.size());
  for (const Symbol& invariant : form.invariants) {
    const Symbol value = rewrite(invariant);
    values.push_back(value.on(tape));
    for (const Symbol& slope : tape::gradient(tape, value, all)) slopes.push_back(slope.on(tape));
  }
  declared_names_ = form.invariant_names;
  declared_ = tape::Formula(tape, values);
  declared_gradients_ = tape::Formula(tape, slopes);

  constexpr int looks = 8;
  constexpr double nothing = 1e-9;
  kept_.assign(values.size(), true);
  Spread spread;
  for (int look = 0; look < looks; ++look) {
    const std::vector<double> x = point(spread), rate = motion_.rates(x, t);
    std::vector<double> gradients(slopes.size());
    declared_gradients_.evaluate(x.data(), t, gradients.data());
    for (std::size_t k = 0; k < values.size(); ++k) {
      double sum = 0, sizes = 0;
      for (std::size_t i = 0; i < rate.size(); ++i) {
        const double part = gradients[k * rate.size() + i] * rate[i];
        sum += part;
        sizes += std::abs(part);
      }
      if (std::abs(sum) > nothing * sizes) kept_[k] = false;
    }
  }
}

/// keeps_energy tells whether ∇H · ẋ = 0 at random points, as in undamped mechanics and under forces that do no work.
bool Conserved::keeps_energy(double t) const {
  constexpr int looks = 8;
  constexpr double nothing = 1e-9;
  if (motion_.symplectic()) return motion_.keeps_energy();
  if (std::isnan(motion_.energy(center_, t))) return false;
  Spread spread;
  for (int look = 0; look < looks; ++look) {
    const std::vector<double> x = point(spread), rate = motion_.rates(x, t), slopes = motion_.energy_gradient(x, t);
    double power = 0, sizes = 0;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      power += slopes[i] * rate[i];
      sizes += std::abs(slopes[i] * rate[i]);
    }
    if (!(std::abs(power) <= nothing * sizes)) return false;
  }
  return true;
}

std::vector<double> Conserved::scaled(std::span<const double> x) const {
  std::vector<double> y(x.size());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = (x[i] - center_[i]) / extents_[i];
  return y;
}

std::vector<double> Conserved::point(Spread& spread) const {
  std::vector<double> x = center_;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += extents_[i] * spread();
  return x;
}

/// find solves Σ c ∇m · ẋ = 0 for coefficients c of monomials m, at more points than there are coefficients.
void Conserved::find(double t, double dt) {
  const std::size_t size = motion_.size();
  const auto all = monomials(size);
  const std::size_t wanted = 2 * all.size() + 4;
  Matrix rows(wanted, all.size());
  Spread spread;
  std::size_t row = 0;
  for (std::size_t tried = 0; row < wanted && tried < 4 * wanted; ++tried) {
    const std::vector<double> x = point(spread), y = scaled(x);
    std::vector<double> rate = motion_.rates(x, t + dt * spread());
    for (std::size_t i = 0; i < size; ++i) rate[i] /= extents_[i];
    const double pace = length(rate);
    if (!all_finite(rate) || !(pace > 0)) continue;
    for (std::size_t k = 0; k < all.size(); ++k) {
      std::vector<double> gradient(size);
      add_slope(all[k], 1, y, gradient);
      rows(row, k) = dot(gradient, rate) / pace;
    }
    ++row;
  }
  if (row < wanted) return;
  constexpr double nothing = 1e-9;
  const Matrix null = orthogonal_to(transposed(rows), nothing);
  found_.reserve(null.columns);
  for (std::size_t k = 0; k < null.columns; ++k) found_.push_back(null.column(k));
}

/// find_decaying solves Σ c (∇m · ẋ + αm) = 0 likewise, in mechanics whose damping α depends on time alone and has mean
/// 0: otherwise such a quantity is 0 on a closed orbit, and orbits are isolated. The constant 1 is added to the
/// monomials, as these are of distances from the center.
void Conserved::find_decaying(double t, double dt) {
  const variations::ParametricScene& equations = motion_.equations();
  if (motion_.coordinates() == 0 || motion_.symplectic() || equations.acting || equations.forced) return;
  constexpr double nothing = 1e-9, hardly = 1e-7, in_the_mean = 1e-10;
  if (!(std::abs(damping_between(t, t + dt, false)) <= in_the_mean * damping_between(t, t + dt, true))) return;
  constexpr std::size_t looks = 8;
  const std::size_t size = motion_.size();
  const auto all = monomials(size);
  const std::size_t unknowns = all.size() + 1, wanted = 2 * unknowns + 4;
  Matrix rows(wanted, unknowns);
  Spread spread;
  std::size_t row = 0;
  for (std::size_t tried = 0; row < wanted && tried < 4 * wanted; ++tried) {
    const std::vector<double> x = point(spread), y = scaled(x);
    const double at = t + dt * spread(), damping = motion_.action_slope(x, at);
    if (damping != motion_.action_slope(center_, at)) return;
    std::vector<double> rate = motion_.rates(x, at);
    for (std::size_t i = 0; i < size; ++i) rate[i] /= extents_[i];
    const double pace = length(rate);
    if (!all_finite(rate) || !std::isfinite(damping) || !(pace > 0)) continue;
    for (std::size_t k = 0; k < all.size(); ++k) {
      std::vector<double> gradient(size);
      add_slope(all[k], 1, y, gradient);
      const auto [i, j] = all[k];
      rows(row, k) = (dot(gradient, rate) + damping * (i == none ? y[j] : y[i] * y[j])) / pace;
    }
    rows(row++, all.size()) = damping / pace;
  }
  if (row < wanted) return;
  const Matrix null = orthogonal_to(transposed(rows), nothing);
  for (std::size_t k = 0; k < null.columns; ++k) {
    std::vector<double> one = null.column(k);
    double around = 0;
    for (std::size_t look = 0; look < looks; ++look)
      around = std::max(around, length(gradient_at(scaled(point(spread)), one, 1)));
    if (length(gradient_at(scaled(center_), one, 1)) > hardly * around) decaying_.push_back(std::move(one));
  }
}

/// damping_between returns ∫α dt, or ∫|α| dt, by three-point Gauss quadrature.
double Conserved::damping_between(double from, double to, bool absolute) const {
  constexpr std::size_t parts = 256;
  constexpr double place = 0.7745966692414834;
  const double part = (to - from) / double(parts);
  double sum = 0;
  for (std::size_t k = 0; k < parts; ++k)
    for (const double at : {-place, 0.0, place}) {
      const double damping = motion_.action_slope(center_, from + part * (double(k) + (1 + at) / 2));
      sum += part * (at == 0 ? 4.0 / 9 : 5.0 / 18) * (absolute ? std::abs(damping) : damping);
    }
  return sum;
}

/// find_felt marks gradients that vanish at the center. The flow transports the gradient of a conserved quantity, so
/// that it vanishes either along the whole orbit or nowhere, as for the energy of a mode at rest. A vanishing gradient
/// makes no equation redundant, and its rounded remains have no meaningful direction.
void Conserved::find_felt(double t) {
  constexpr int looks = 8;
  constexpr double nothing = 1e-7;
  const auto lengths_at = [&](std::span<const double> x) {
    const Matrix gradients = raw_gradients(x, t);
    std::vector<double> lengths;
    for (std::size_t k = 0; k < gradients.columns; ++k) lengths.push_back(length(gradients.column(k)));
    return lengths;
  };
  const std::vector<double> here = lengths_at(center_);
  std::vector<double> around(here.size());
  Spread spread;
  for (int look = 0; look < looks; ++look) {
    const std::vector<double> there = lengths_at(point(spread));
    for (std::size_t k = 0; k < around.size(); ++k)
      if (std::isfinite(there[k])) around[k] = std::max(around[k], there[k]);
  }
  for (std::size_t k = 0; k < here.size(); ++k) felt_.push_back(!(here[k] <= nothing * around[k]));
}

Matrix Conserved::raw_gradients(std::span<const double> x, double t) const {
  const std::size_t size = motion_.size();
  Matrix columns(size, 0);
  std::size_t number = 0;
  const auto add = [&](std::span<const double> gradient) {
    if (felt_.empty() || felt_[number]) columns.add_column({gradient.begin(), gradient.end()});
    ++number;
  };
  const auto in_units = [&](std::span<const double> gradient) {
    std::vector<double> made(size);
    for (std::size_t i = 0; i < size; ++i) made[i] = gradient[i] * extents_[i];
    return made;
  };
  if (energy_kept_) add(in_units(motion_.energy_gradient(x, t)));
  if (!declared_names_.empty()) {
    std::vector<double> slopes(declared_gradients_.outputs());
    declared_gradients_.evaluate(x.data(), t, slopes.data());
    for (std::size_t k = 0; k < declared_names_.size(); ++k)
      if (kept_[k]) add(in_units(std::span(slopes).subspan(k * size, size)));
  }
  const std::vector<double> y = scaled(x);
  for (const auto& coefficients : found_) add(gradient_at(y, coefficients, 1));
  if (decaying_.empty()) return columns;
  const double grown = std::exp(damping_between(start_, t, false));  // conserved is I e^{∫α dt}
  for (const auto& coefficients : decaying_) add(gradient_at(y, coefficients, grown));
  return columns;
}

std::vector<double> Conserved::gradient_at(std::span<const double> y, std::span<const double> coefficients,
                                           double factor) const {
  const auto all = monomials(motion_.size());
  std::vector<double> gradient(motion_.size());
  for (std::size_t k = 0; k < all.size(); ++k) add_slope(all[k], factor * coefficients[k], y, gradient);
  return gradient;
}

Matrix Conserved::raw_symmetries(std::span<const double> x, double t) const {
  const std::size_t size = motion_.size(), n = motion_.coordinates();
  Matrix columns(size, 0);
  if (motion_.autonomous()) {
    std::vector<double> rate = motion_.rates(x, t);
    for (std::size_t i = 0; i < size; ++i) rate[i] /= extents_[i];
    columns.add_column(rate);
  }
  Matrix of = motion_.symplectic() ? raw_gradients(x, t) : Matrix(size, 0);
  for (const auto& coefficients : decaying_) of.add_column(gradient_at(scaled(x), coefficients, 1));
  for (std::size_t k = 0; k < of.columns; ++k) {  // q̇ = ∂I/∂p, ṗ = −∂I/∂q; for I = H this is ẋ again
    std::vector<double> way(size);
    for (std::size_t i = 0; i < n; ++i) {
      way[i] = of(n + i, k) / (extents_[n + i] * extents_[i]);
      way[n + i] = -of(i, k) / (extents_[i] * extents_[n + i]);
    }
    columns.add_column(way);
  }
  return columns;
}

std::vector<std::pair<std::string, double>> Conserved::declared(std::span<const double> x, double t) const {
  std::vector<double> values(declared_names_.size());
  if (!values.empty()) declared_.evaluate(x.data(), t, values.data());
  std::vector<std::pair<std::string, double>> all;
  all.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) all.emplace_back(declared_names_[i], values[i]);
  return all;
}

}  // namespace least::periodic
