#include "core/run/tangent_length.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/memory_budget.hpp"
#include "core/number/linear.hpp"
#include "core/run/control_stepper.hpp"
#include "core/state_error.hpp"

namespace least {
namespace {

/// A larger full matrix would take too long to decompose between two looks at the clock.
constexpr std::size_t largest_full_matrix = 512;

bool is_diagonal(std::size_t n, const std::vector<double>& matrix) {
  for (std::size_t i = 0; i < matrix.size(); ++i)
    if (matrix[i] != 0 && i % (n + 1) != 0) return false;
  return true;
}

/// has_inverse returns whether a matrix (n × n, row-major) is known to have an inverse.
bool has_inverse(std::size_t n, std::vector<double> matrix) {
  if (is_diagonal(n, matrix)) {
    for (std::size_t i = 0; i < n; ++i)
      if (const double entry = matrix[i * (n + 1)]; entry == 0 || !std::isfinite(entry)) return false;
    return true;
  }
  if (n > largest_full_matrix) return false;
  const double determinant = detail::determinant_by_lu(n, matrix.data());
  return std::isfinite(determinant) && determinant != 0;
}

}  // namespace

TangentLength::TangentLength(const RunBackend& backend, const RunState& x, double end,
                             std::span<const std::size_t> kinds, const KeepGoing& keep_going)
    : backend_(backend),
      flow_(backend.motion().traits.flow),
      size_(backend.motion().traits.components),
      n_(flow_ ? size_ : backend.motion().traits.dof),
      extent_(size_, 0.0) {
  if (!flow_) by_velocities_ = has_kinetic_matrix(x, keep_going);
  measure(x, end, kinds, keep_going);
  first_ = direction(x, keep_going);
  const double length = (*this)(x, first_.data());
  for (double& component : first_) component /= length;
}

double TangentLength::operator()(StateView x, const double* u) const {
  double square = 0;
  const StateNumbers seen = as_measured(x, u);
  for (std::size_t i = 0; i < size_; ++i) square += (seen[i] / extent_[i]) * (seen[i] / extent_[i]);
  return std::sqrt(square);
}

/// velocity_slopes returns the derivative of q̇ along a tangent.
StateNumbers TangentLength::velocity_slopes(StateView x, const double* u) const {
  StateNumbers slopes(n_);
  backend_.velocity_slopes(x, u, slopes.data());
  return slopes;
}

/// inverse_masses returns ∂q̇/∂p, row-major, with rows and columns of the identity for coordinates that the scene does
/// not have. Empty if there is no time for it.
std::vector<double> TangentLength::inverse_masses(StateView x, const KeepGoing& keep_going) const {
  std::vector<double> inverse(n_ * n_);
  for (std::size_t j = 0; j < n_; ++j) {
    if (j % 16 == 15 && !keep_going()) return {};
    StateNumbers u(size_, 0.0);
    u[n_ + j] = 1;
    const auto column = velocity_slopes(x, u.data());
    for (std::size_t i = 0; i < n_; ++i)
      inverse[i * n_ + j] = backend_.has_component(i) && backend_.has_component(j) ? column[i] : double(i == j);
  }
  return inverse;
}

/// has_kinetic_matrix returns whether H is quadratic in p with an invertible matrix, or a Lagrangian defines
/// velocities.
bool TangentLength::has_kinetic_matrix(const RunState& x, const KeepGoing& keep_going) const {
  if (!backend_.motion().traits.general || backend_.found() > 0) return true;
  const Held held = HeldByThread::take(3 * n_ * n_ * sizeof(double));
  RunState other = x;
  for (std::size_t i = 0; i < n_; ++i) other[n_ + i] = 1 + 2 * x[n_ + i];
  const auto here = inverse_masses(x, keep_going), there = inverse_masses(other, keep_going);
  if (here.size() != there.size() || here.empty()) return false;
  double change = 0, most = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    change = std::max(change, std::abs(here[i] - there[i]));
    most = std::max(most, std::abs(here[i]));
  }
  return change <= 1e-9 * most && has_inverse(n_, here);
}

/// as_measured returns a tangent as the norm reads it: with changes of velocities in the place of those of momenta.
StateNumbers TangentLength::as_measured(StateView x, const double* u) const {
  StateNumbers seen(u, u + size_);
  if (by_velocities_) backend_.velocity_slopes(x, u, seen.data() + n_);
  return seen;
}

void TangentLength::measure(RunState x, double end, std::span<const std::size_t> kinds, const KeepGoing& keep_going) {
  constexpr int steps = 128;
  constexpr double tolerance = 1e-5;
  ControlStepper stepper(backend_, tolerance);
  std::optional<StateNumbers> low, high;
  StateNumbers largest(size_, 0.0);
  const auto see = [&] {
    StateNumbers seen = x.numbers;
    if (by_velocities_) backend_.velocity(x, seen.data() + n_);
    if (!std::ranges::all_of(seen, [](double component) { return std::isfinite(component); })) return false;
    if (!low) low = high = seen;
    for (std::size_t i = 0; i < size_; ++i) {
      (*low)[i] = std::min((*low)[i], seen[i]);
      (*high)[i] = std::max((*high)[i], seen[i]);
      largest[i] = std::max(largest[i], std::abs(seen[i]));
    }
    return true;
  };
  for (int step = 0; see() && step < steps && x.t < end && keep_going(); ++step)
    if (stepper.step(x) != StepStatus::ok) break;
  for (std::size_t i = 0; i < size_; ++i) {
    const double range = low ? (*high)[i] - (*low)[i] : 0, grain = 1e-12 * largest[i];
    const bool from_zero = !flow_ && n_ <= i && i < 2 * n_;  // velocities and momenta have a zero, positions do not
    extent_[i] = from_zero ? largest[i] : range > grain ? range : 0;
  }
  ComponentSizes of_kind(kinds, size_);
  for (std::size_t i = 0; i < size_; ++i) of_kind.see(i, extent_[i]);
  for (std::size_t i = 0; i < size_; ++i) extent_[i] = of_kind.largest(i);
  share(0, n_, largest);
  if (!flow_) share(n_, 2 * n_, largest);
  if (!flow_ && size_ > 2 * n_) share(2 * n_, size_, largest);
}

/// share gives extents within a factor of 32 of each other the largest of them, as lengths in one unit: otherwise the
/// norm in a plane would change when the plane is turned. Components at rest get the largest extent of the others, and
/// if all rest the largest size of a component.
void TangentLength::share(std::size_t begin, std::size_t end, const StateNumbers& largest) {
  constexpr double alike = 32;
  const auto part = [&](auto& all) { return std::span(all.data() + begin, end - begin); };
  const double all = std::ranges::max(part(extent_)), place = std::ranges::max(part(largest));
  const StateNumbers own = extent_;
  double above = all > 0 ? all : place > 0 ? place : 1;
  for (double& extent : part(extent_))
    if (extent == 0) extent = above;
  for (double next = above; next > 0; above = next) {
    next = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (own[i] == 0 || own[i] > above) continue;
      if (own[i] * alike >= above)
        extent_[i] = above;
      else
        next = std::max(next, own[i]);
    }
  }
}

StateNumbers TangentLength::direction(StateView x, const KeepGoing& keep_going) const {
  StateNumbers u(size_, 0.0);
  double count = 0;
  for (std::size_t i = 0; i < size_; ++i)
    if (backend_.has_component(i)) u[i] = extent_[i] * std::pow(++count, -2.0 / 3);
  if (!by_velocities_) return u;
  StateNumbers at_rest = u;  // the tangent of coordinates alone
  for (std::size_t i = 0; i < n_; ++i) at_rest[n_ + i] = 0;
  StateNumbers wanted(n_), momenta(n_);
  const StateNumbers moved = velocity_slopes(x, at_rest.data());
  for (std::size_t i = 0; i < n_; ++i) wanted[i] = u[n_ + i] - moved[i];
  const Held held = HeldByThread::take(n_ * n_ * sizeof(double));
  auto masses = inverse_masses(x, keep_going);
  if (masses.empty()) return u;
  const bool diagonal = is_diagonal(n_, masses);
  if (!diagonal && n_ > largest_full_matrix) return u;
  for (std::size_t i = 0; i < n_ && diagonal; ++i) momenta[i] = wanted[i] / masses[i * (n_ + 1)];
  if (!diagonal) detail::solve_by_lu(n_, masses.data(), wanted.data(), momenta.data());
  if (std::ranges::all_of(momenta, [](double p) { return std::isfinite(p); }))
    std::ranges::copy(momenta, u.begin() + static_cast<std::ptrdiff_t>(n_));
  return u;
}

}  // namespace least
