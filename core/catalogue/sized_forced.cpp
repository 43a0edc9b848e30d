#include "core/catalogue/sized_forced.hpp"

#include <algorithm>
#include <cmath>

#include "core/number/linear.hpp"

namespace least {

ForcedKick::ForcedKick(const text::SizedScene& scene)
    : scene_(&scene),
      n_(scene.coordinates),
      at_(2 * n_),
      looked_(scene.forces.jacobian.outputs()),
      rate_(n_),
      change_(n_),
      middle_(n_),
      velocity_(n_),
      turned_(TurnedMomenta::of(scene)),
      known_(std::make_shared<std::vector<Known>>()) {
  diagonal_ = scene.forces.diagonal && !turned_;
  if (!turned_) return;
  looked_.resize(n_ + n_ * n_);
  state_.resize(2 * n_ + 1);
  slope_.resize(n_);
  given_.resize(n_);
}

void ForcedKick::velocity_of(const double* p, double* v) const {
  if (!turned_) return scene_->velocity(p, v);
  for (std::size_t i = 0; i < n_; ++i) v[i] = turned_->inverse_mass[i] * p[i];
}

StepStatus ForcedKick::kick(double* x, const double* slope, double t, double h, Work& work) {
  if (!turned_) return kick_along(x, slope, t, h, work);
  constexpr double rounding = 16 * std::numeric_limits<double>::epsilon();
  std::copy_n(x, 2 * n_ + 1, state_.begin());
  double* const y = state_.data() + n_;
  multiply(turned_->to, x + n_, y);
  multiply(turned_->to, slope, slope_.data());
  beside_rest_ = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < n_; ++i) beside_rest_ = std::max(beside_rest_, rounding * std::abs(x[n_ + i]));
  for (std::size_t i = 0; i < n_; ++i)
    if (jumps(i) && std::abs(y[i]) < beside_rest_) y[i] = 0;
  const StepStatus status = kick_along(state_.data(), slope_.data(), t, h, work);
  if (status != StepStatus::ok) return status;
  multiply(turned_->back, y, x + n_);
  x[2 * n_] = state_[2 * n_];
  return status;
}

StepStatus ForcedKick::kick_along(double* x, const double* slope, double t, double h, Work& work) {
  if (scene_->forces.linear) {
    exact(x, slope, t, h);
  } else {
    StepStatus status = midpoint(x, slope, t, h, work);
    if (turned_ || (scene_->forces.can_rest() && !scene_->has_full_mass())) {
      bool slides = status == StepStatus::ok;  // whether every momentum whose force jumps stays on its side of 0
      for (std::size_t i = 0; i < n_ && slides; ++i) slides = !jumps(i) || x[n_ + i] * (x[n_ + i] + change_[i]) > 0;
      if (!slides) status = through_rest(x, slope, t, h, work);
    }
    if (status != StepStatus::ok) return status;
  }
  for (std::size_t i = 0; i < n_; ++i) x[n_ + i] = x[n_ + i] + change_[i];
  x[2 * n_] = x[2 * n_] + work_;
  return StepStatus::ok;
}

void ForcedKick::look(const double* x, const double* p, double t) {
  std::copy_n(x, n_, at_.begin());
  if (p && turned_) {
    multiply(turned_->back, p, at_.data() + n_);
  } else if (p) {
    std::copy_n(p, n_, at_.data() + n_);
  } else {
    std::fill_n(at_.data() + n_, n_, 0.0);
  }
  scene_->forces.jacobian.evaluate(at_.data(), t, looked_.data());
  if (!turned_) return;
  std::copy_n(looked_.begin(), n_, given_.begin());
  multiply(turned_->to, given_.data(), looked_.data());
  double* const jacobian = looked_.data() + n_;
  if (scene_->forces.diagonal) {
    std::copy_n(jacobian, n_, given_.begin());
    std::fill_n(jacobian, n_ * n_, 0.0);
    for (std::size_t i = 0; i < n_; ++i) jacobian[i * n_ + i] = given_[i];
  }
  for (std::size_t j = 0; j < n_; ++j) {  // T J, column by column, then times T⁻¹, row by row
    for (std::size_t i = 0; i < n_; ++i) given_[i] = jacobian[i * n_ + j];
    for (std::size_t i = 0; i < n_; ++i) {
      jacobian[i * n_ + j] = 0;
      for (std::size_t k = 0; k < n_; ++k) jacobian[i * n_ + j] += turned_->to[i * n_ + k] * given_[k];
    }
  }
  for (std::size_t i = 0; i < n_; ++i) {
    std::copy_n(jacobian + i * n_, n_, given_.begin());
    for (std::size_t j = 0; j < n_; ++j) {
      jacobian[i * n_ + j] = 0;
      for (std::size_t k = 0; k < n_; ++k) jacobian[i * n_ + j] += given_[k] * turned_->back[k * n_ + j];
    }
  }
}

/// exact: with ṗ = w at the start, p changes by h φ₁(hB) w, and its mean is p + h φ₂(hB) w. The work is the change of K
/// minus that of −∇V, whose power is linear in p.
void ForcedKick::exact(const double* x, const double* slope, double t, double h) {
  const double *const p = x + n_, *const jacobian = looked_.data() + n_;
  look(x, nullptr, t);
  for (std::size_t i = 0; i < n_; ++i) rate_[i] = looked_[i] - slope[i];
  if (diagonal_) {
    for (std::size_t i = 0; i < n_; ++i) {
      const Phi of = phi(h * jacobian[i]);
      const double rate = rate_[i] + jacobian[i] * p[i];
      change_[i] = h * of.one * rate;
      middle_[i] = p[i] + h * of.two * rate;
    }
  } else {
    const MatrixPhi& of = phi_of(h);
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < n_; ++j) rate_[i] += jacobian[i * n_ + j] * p[j];
    for (std::size_t i = 0; i < n_; ++i) {
      double change = 0, mean = 0;
      for (std::size_t j = 0; j < n_; ++j) {
        change += of.one[i * n_ + j] * rate_[j];
        mean += of.two[i * n_ + j] * rate_[j];
      }
      change_[i] = h * change;
      middle_[i] = p[i] + h * mean;
    }
  }
  scene_->velocity(middle_.data(), velocity_.data());
  work_ = 0;
  for (std::size_t i = 0; i < n_; ++i) work_ += h * slope[i] * velocity_[i];
  for (std::size_t i = 0; i < n_; ++i) middle_[i] = p[i] + 0.5 * change_[i];
  scene_->velocity(middle_.data(), velocity_.data());
  for (std::size_t i = 0; i < n_; ++i) work_ += change_[i] * velocity_[i];
}

/// midpoint solves m = p + (h/2)(−∇V + F(q, m, t)) for the midpoint m. The work is that of F at m, so that it is the
/// change of K minus the work of −∇V to round-off.
StepStatus ForcedKick::midpoint(const double* x, const double* slope, double t, double h, Work& work) {
  constexpr int most_rounds = 50;
  const double *const p = x + n_, *const jacobian = looked_.data() + n_;
  const bool diagonal = diagonal_;
  std::copy_n(p, n_, middle_.begin());
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    look(x, middle_.data(), t);
    ++work.forces;
    ++work.iterations;
    double changed = 0, size = std::numeric_limits<double>::min();
    for (std::size_t i = 0; i < n_; ++i) {
      change_[i] = h * (looked_[i] - slope[i]);
      rate_[i] = middle_[i] - p[i] - 0.5 * change_[i];  // residual
      size += std::abs(p[i]) + std::abs(change_[i]);
    }
    if (!diagonal) {
      matrix_.resize(n_ * n_);
      for (std::size_t i = 0; i < n_; ++i)
        for (std::size_t j = 0; j < n_; ++j) matrix_[i * n_ + j] = (i == j ? 1 : 0) - 0.5 * h * jacobian[i * n_ + j];
      detail::invert(n_, matrix_.data());
    }
    for (std::size_t i = 0; i < n_; ++i) {
      double update = rate_[i] / (1 - 0.5 * h * jacobian[i]);
      if (!diagonal) {
        update = 0;
        for (std::size_t j = 0; j < n_; ++j) update += matrix_[i * n_ + j] * rate_[j];
      }
      middle_[i] -= update;
      changed += std::abs(update);
    }
    if (!(changed < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
    const double small = 8 * std::numeric_limits<double>::epsilon() * size;
    if (!(changed <= small || (changed >= 0.5 * before && changed <= 1e3 * small))) {
      before = changed;
      continue;
    }
    for (std::size_t i = 0; i < n_; ++i) middle_[i] = p[i] + 0.5 * change_[i];
    velocity_of(middle_.data(), velocity_.data());
    work_ = 0;
    for (std::size_t i = 0; i < n_; ++i) work_ += h * looked_[i] * velocity_[i];
    return StepStatus::ok;
  }
  return StepStatus::solver_failed;
}

/// look_beside_rest evaluates ṗ on either side of rest, with the other momenta as they are. If each force depends on
/// its own momentum alone, all are evaluated together.
void ForcedKick::look_beside_rest(const double* x, const double* slope, double t, std::size_t which) {
  const bool together = diagonal_;
  if (together && looked_beside_) return;
  looked_beside_ = true;
  for (auto* const rates : {&above_, &below_}) {
    const double beside = rates == &above_ ? beside_rest_ : -beside_rest_;
    if (together) {
      velocity_.assign(n_, beside);
    } else {
      std::copy_n(x + n_, n_, velocity_.begin());
      velocity_[which] = beside;
    }
    look(x, velocity_.data(), t);
    for (std::size_t i = 0; i < n_; ++i)
      if (together || i == which) (*rates)[i] = looked_[i] - slope[i];
  }
}

StepStatus ForcedKick::through_rest(const double* x, const double* slope, double t, double h, Work& work) {
  constexpr int most_rounds = 50;
  const double* const p = x + n_;
  const bool diagonal = diagonal_;
  side_.resize(n_);
  above_.resize(n_);
  below_.resize(n_);
  looked_beside_ = false;
  const auto holds = [&](std::size_t i) { return above_[i] <= 0 && below_[i] >= 0; };
  for (std::size_t i = 0; i < n_; ++i) {
    if (p[i] == 0 && jumps(i)) look_beside_rest(x, slope, t, i);
    side_[i] = p[i] > 0 ? 1 : p[i] < 0 ? -1 : !jumps(i) || holds(i) ? 0 : h * above_[i] > 0 ? 1 : -1;
    middle_[i] = p[i];
  }
  // Newton's method for the midpoint; a momentum whose force jumps stays on its side.
  const auto rests = [&](std::size_t i) { return jumps(i) && side_[i] == 0; };
  const auto inside = [&](std::size_t i) { return !jumps(i) || side_[i] * middle_[i] > beside_rest_; };
  bool solved = false;
  for (int round = 0; round < most_rounds && !solved; ++round) {
    for (std::size_t i = 0; i < n_; ++i)
      velocity_[i] = jumps(i) ? side_[i] * std::max(side_[i] * middle_[i], beside_rest_) : middle_[i];
    look(x, velocity_.data(), t);
    ++work.forces;
    ++work.iterations;
    double changed = 0, size = std::numeric_limits<double>::min();
    for (std::size_t i = 0; i < n_; ++i) {
      change_[i] = rests(i) ? 0 : h * (looked_[i] - slope[i]);
      rate_[i] = middle_[i] - p[i] - 0.5 * change_[i];
      size += std::abs(p[i]) + std::abs(change_[i]);
    }
    solve_on_sides(h, diagonal, rests, inside);
    for (std::size_t i = 0; i < n_; ++i) {
      middle_[i] -= rate_[i];
      changed += std::abs(rate_[i]);
    }
    solved = changed <= 8 * std::numeric_limits<double>::epsilon() * size;
  }
  if (!solved) return StepStatus::solver_failed;
  work_ = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    // The part of F in a change of p does work along the mean momentum.
    const auto part = [&](double change, double mean, double time) {
      work_ += (change + time * slope[i]) * (inverse_mass(i) * mean);
    };
    if (rests(i)) continue;
    if (!jumps(i) || side_[i] * (p[i] + change_[i]) > 0) {
      part(change_[i], p[i] + 0.5 * change_[i], h);
      continue;
    }
    look_beside_rest(x, slope, t, i);
    const double until = h * (p[i] / -change_[i]), left = h - until;
    const double beyond = holds(i) ? 0 : left * (side_[i] > 0 ? below_[i] : above_[i]);
    part(-p[i], 0.5 * p[i], until);
    part(beyond, 0.5 * beyond, left);
    change_[i] = beyond - p[i];
  }
  return StepStatus::ok;
}

/// solve_on_sides replaces the residual of the midpoint in `rate_` by the correction. A momentum that rests, or reaches
/// the end of its side, is fixed: others do not react to it.
template <class Rests, class Inside>
void ForcedKick::solve_on_sides(double h, bool diagonal, const Rests& rests, const Inside& inside) {
  const double* const jacobian = looked_.data() + n_;
  if (diagonal) {
    for (std::size_t i = 0; i < n_; ++i) rate_[i] /= inside(i) ? 1 - 0.5 * h * jacobian[i] : 1;
    return;
  }
  matrix_.resize(n_ * n_);
  for (std::size_t i = 0; i < n_; ++i)
    for (std::size_t j = 0; j < n_; ++j)
      matrix_[i * n_ + j] = (i == j ? 1 : 0) - (rests(i) || !inside(j) ? 0 : 0.5 * h * jacobian[i * n_ + j]);
  detail::invert(n_, matrix_.data());
  std::copy(rate_.begin(), rate_.end(), velocity_.begin());
  for (std::size_t i = 0; i < n_; ++i) {
    rate_[i] = 0;
    for (std::size_t j = 0; j < n_; ++j) rate_[i] += matrix_[i * n_ + j] * velocity_[j];
  }
}

const MatrixPhi& ForcedKick::phi_of(double h) {
  constexpr std::size_t most_known = 64;
  auto& all = *known_;
  if (scene_->forces.constant)
    if (const auto found = std::ranges::find(all, h, &Known::h); found != all.end()) return found->phi;
  matrix_.assign(looked_.begin() + static_cast<std::ptrdiff_t>(n_), looked_.end());
  for (double& entry : matrix_) entry *= h;
  if (all.empty() || (scene_->forces.constant && all.size() < most_known)) all.emplace_back();
  all.back() = {h, phi(n_, matrix_)};
  return all.back().phi;
}

ForcedKickDrift::ForcedKickDrift(const text::SizedScene& scene, std::vector<Piece> pieces)
    : scene_(&scene),
      pieces_(std::move(pieces)),
      kick_(scene),
      slope_(scene.coordinates),
      velocity_(scene.coordinates) {}

void ForcedKickDrift::begin(const double* x, double t) {
  work_ = {};
  look(x, t);
}

StepStatus ForcedKickDrift::step(double* x, double t, double h) noexcept {
  const double* const p = x + scene_->coordinates;
  double here = t, gone = 0;
  for (const Piece& piece : pieces_) {
    if (piece.before != 0)
      if (const auto status = kick_.kick(x, slope_.data(), here, h * piece.before, work_); status != StepStatus::ok)
        return status;
    scene_->velocity(p, velocity_.data());
    for (std::size_t i = 0; i < velocity_.size(); ++i) x[i] = x[i] + (h * piece.over) * velocity_[i];
    gone += piece.over;
    here = t + h * gone;
    look(x, here);
    if (piece.after != 0)
      if (const auto status = kick_.kick(x, slope_.data(), here, h * piece.after, work_); status != StepStatus::ok)
        return status;
  }
  return StepStatus::ok;
}

void ForcedKickDrift::look(const double* q, double t) {
  scene_->gradient.evaluate(q, t, slope_.data());
  ++work_.forces;
}

std::vector<ForcedKickDrift::Piece> pieces_of(const Leapfrog& scheme) {
  const auto& weights = Weights<double>::of(scheme.composition);
  std::vector<ForcedKickDrift::Piece> all;
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights.stages); ++i)
    all.push_back({weights.gamma[i] / 2, weights.gamma[i], weights.gamma[i] / 2});
  return all;
}

}  // namespace least
