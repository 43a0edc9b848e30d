// A scene's motion over some time with its derivatives, as what closes orbits asks for it again and again.
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

/// What a request may still cost. Once it says no it goes on saying no.
class Effort {
 public:
  Effort(KeepGoing keep_going, std::int64_t most_steps) : keep_going_(std::move(keep_going)), most_(most_steps) {}

  /// Before each step.
  bool go() {
    if (over_) return false;
    if (++steps_ > most_) out_of_steps_ = true;
    over_ = out_of_steps_ || !keep_going_();
    return !over_;
  }
  bool over() const { return over_; }
  bool out_of_steps() const { return out_of_steps_; }
  /// What is over, in words.
  const char* why() const {
    return out_of_steps_ ? "the steps that the request has were taken" : "the time that the request has was over";
  }
  std::int64_t steps() const { return steps_; }

 private:
  KeepGoing keep_going_;
  std::int64_t most_, steps_ = 0;
  bool over_ = false, out_of_steps_ = false;
};

/// Where a motion comes to, and how that changes.
struct Reached {
  std::vector<double> state;
  Matrix by_start;                   ///< ∂x(t₁)/∂x(t₀)
  std::vector<double> by_parameter;  ///< by the parameter that is varied; empty: none is
};

class Motion {
 public:
  using Equations = std::shared_ptr<const variations::ParametricScene>;

  /// `varied`: the parameter of the card that derivatives are by, too. `tolerance`: as of the scheme `taylor`. Throws
  /// tape::TooManyOperations where the equations of a single derivative are too long, MemoryShortage.
  Motion(Equations equations, std::optional<std::size_t> varied, double tolerance);

  const variations::ParametricScene& equations() const { return *equations_; }
  std::size_t size() const { return equations_->components; }
  std::size_t coordinates() const { return equations_->coordinates; }
  bool autonomous() const { return autonomous_; }
  /// Whether H is kept, and symplectic maps are what the motion consists of.
  bool keeps_energy() const { return keeps_energy_; }
  bool symplectic() const { return symplectic_; }

  std::vector<double> rates(std::span<const double> x, double t) const { return values(rates_, x, t); }
  /// H; NaN where there is none.
  double energy(std::span<const double> x, double t) const { return values(energy_, x, t)[0]; }
  std::vector<double> energy_gradient(std::span<const double> x, double t) const;
  /// ∂H/∂s: areas shrink by e^{−∫∂H/∂s dt}.
  double action_slope(std::span<const double> x, double t) const { return values(action_slope_, x, t)[0]; }
  /// Σ ∂ẋᵢ/∂xᵢ; NaN where its formula is too long. Made when it is asked for, which is seldom.
  double divergence(std::span<const double> x, double t);

  /// From x at t over a time dt > 0. Nothing: it cannot be followed, for the reason given.
  std::optional<Reached> follow(std::span<const double> x, double t, double dt, Effort& effort, std::string& reason);
  /// The state alone, at these times, which increase. What was reached in time where it cannot be followed.
  std::vector<std::vector<double>> path(std::span<const double> x, double t, std::span<const double> times,
                                        Effort& effort, std::string& reason);

 private:
  struct Part {
    std::size_t first, count;  ///< of the directions
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

/// Numbers between −1 and 1, the same ones everywhere.
class Spread {
 public:
  double operator()() { return 2 * (static_cast<double>(engine_()) / 4294967295.0) - 1; }

 private:
  std::mt19937 engine_;
};

}  // namespace least::periodic
