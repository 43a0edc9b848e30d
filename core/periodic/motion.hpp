// The motion of a scene over some time and its derivatives, which closing an orbit evaluates again and again.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/periodic/dense.hpp"
#include "core/run/mechanics.hpp"
#include "core/tape/formula.hpp"
#include "core/variations/parametric.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::periodic {

/// Effort counts steps and time of a request against its limits. Once it has run out, it stays so.
class Effort {
 public:
  Effort(KeepGoing keep_going, std::int64_t most_steps) : keep_going_(std::move(keep_going)), most_(most_steps) {}

  /// go() is called before each step and tells whether the step may be taken.
  bool go() {
    if (over_) return false;
    if (++steps_ > most_) out_of_steps_ = true;
    over_ = out_of_steps_ || !keep_going_();
    return !over_;
  }
  bool over() const { return over_; }
  bool out_of_steps() const { return out_of_steps_; }
  /// why() says which limit was reached.
  const char* why() const {
    return out_of_steps_ ? "the steps that the request has were taken" : "the time that the request has was over";
  }
  std::int64_t steps() const { return steps_; }

 private:
  KeepGoing keep_going_;
  std::int64_t most_, steps_ = 0;
  bool over_ = false, out_of_steps_ = false;
};

/// Reached is the end of a motion and its derivatives.
struct Reached {
  std::vector<double> state;
  Matrix by_start;                   ///< ∂x(t₁)/∂x(t₀)
  std::vector<double> by_parameter;  ///< ∂x(t₁)/∂θ by the varied parameter θ; empty where none is varied
};

/// Motion evaluates the equations of a ParametricScene and follows their solutions.
class Motion {
 public:
  using Equations = std::shared_ptr<const variations::ParametricScene>;

  /// `varied` is a parameter of the card to differentiate by as well; `tolerance` is that of the scheme `taylor`.
  /// Throws tape::TooManyOperations where even a single direction has too long equations, MemoryShortage.
  Motion(Equations equations, std::optional<std::size_t> varied, double tolerance);

  const variations::ParametricScene& equations() const { return *equations_; }
  std::size_t size() const { return equations_->components; }
  std::size_t coordinates() const { return equations_->coordinates; }
  bool autonomous() const { return autonomous_; }
  /// keeps_energy() tells whether H is conserved, symplectic() whether the flow is symplectic.
  bool keeps_energy() const { return keeps_energy_; }
  bool symplectic() const { return symplectic_; }

  std::vector<double> rates(std::span<const double> x, double t) const { return values(rates_, x, t); }
  /// energy returns H; NaN where there is none.
  double energy(std::span<const double> x, double t) const { return values(energy_, x, t)[0]; }
  std::vector<double> energy_gradient(std::span<const double> x, double t) const;
  /// action_slope returns ∂H/∂s: the flow scales dq∧dp by e^{−∫∂H/∂s dt}.
  double action_slope(std::span<const double> x, double t) const { return values(action_slope_, x, t)[0]; }
  /// divergence returns Σ ∂ẋᵢ/∂xᵢ; NaN where its formula is too long. The formula is made on first use, as it is seldom
  /// needed.
  double divergence(std::span<const double> x, double t);

  /// follow integrates from x at time t over dt > 0. Nothing where the motion cannot be followed; `reason` then says
  /// why.
  std::optional<Reached> follow(std::span<const double> x, double t, double dt, Effort& effort, std::string& reason);
  /// path returns the states at these ascending times. Where the motion cannot be followed, it stops at the last
  /// reached time.
  std::vector<std::vector<double>> path(std::span<const double> x, double t, std::span<const double> times,
                                        Effort& effort, std::string& reason);

 private:
  struct Part {
    std::size_t first, count;  ///< range of directions
    variations::VariedMotion motion;
  };
  std::vector<double> values(const tape::Formula& formula, std::span<const double> x, double t) const;
  bool go_to(variations::VariedMotion& motion, double end, Effort& effort, std::string& reason) const;

  Equations equations_;
  std::optional<std::size_t> varied_;
  bool autonomous_, keeps_energy_, symplectic_;
  tape::Formula rates_, energy_, energy_gradient_, action_slope_;
  std::optional<tape::Formula> divergence_;
  std::vector<Part> parts_;
  variations::VariedMotion alone_;
};

/// Spread returns pseudo-random numbers between −1 and 1, the same sequence on all platforms.
class Spread {
 public:
  double operator()() { return 2 * (static_cast<double>(engine_()) / 4294967295.0) - 1; }

 private:
  std::mt19937 engine_;
};

}  // namespace least::periodic
