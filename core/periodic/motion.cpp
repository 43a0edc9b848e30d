#include "core/periodic/motion.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/run/messages.hpp"
#include "core/tape/derivative.hpp"
#include "core/variations/start.hpp"

namespace least::periodic {
namespace {

bool reads_time(const variations::ParametricScene& scene) {
  tape::Dependences depends(scene.tape, [](int) { return tape::Dependence(0); });
  return std::ranges::any_of(scene.rates, [&](const Symbol& rate) { return depends(rate) != 0; });
}

tape::Formula gradient_of_energy(const variations::ParametricScene& scene) {
  tape::Tape tape = scene.tape;
  std::vector<int> all(scene.components);
  std::iota(all.begin(), all.end(), 0);
  const Symbol energy = scene.energy.is_constant() ? scene.energy : Symbol::at(tape, scene.energy.place());
  std::vector<tape::Index> places;
  for (const Symbol& slope : tape::gradient(tape, energy, all)) places.push_back(slope.on(tape));
  return {tape, places};
}

tape::Formula divergence_of(const variations::ParametricScene& scene) {
  tape::Tape tape = scene.tape;
  Symbol sum;
  for (std::size_t i = 0; i < scene.components; ++i) {
    const Symbol& given = scene.rates[i];
    const Symbol rate = given.is_constant() ? given : Symbol::at(tape, given.place());
    const int by = static_cast<int>(i);
    sum += tape::gradient(tape, rate, std::span(&by, 1))[0];
  }
  const tape::Index place = sum.on(tape);
  return {tape, std::span(&place, 1)};
}

}  // namespace

Motion::Motion(Equations equations, std::optional<std::size_t> varied, double tolerance)
    : equations_(std::move(equations)),
      varied_(varied),
      rates_(variations::formula_of(*equations_, equations_->rates)),
      energy_(variations::formula_of(*equations_, {equations_->energy})),
      energy_gradient_(gradient_of_energy(*equations_)),
      action_slope_(variations::formula_of(*equations_, {equations_->action_slope})),
      alone_(*equations_, {}, {}, tolerance) {
  const variations::ParametricScene& scene = *equations_;
  autonomous_ = !reads_time(scene);
  const bool no_energy = scene.energy.is_constant() && std::isnan(scene.energy.constant());
  const bool undamped = scene.action_slope.is_constant() && scene.action_slope.constant() == 0;
  symplectic_ = scene.coordinates > 0 && !scene.forced && !scene.acting && undamped;
  keeps_energy_ = symplectic_ && autonomous_ && !no_energy;
  const std::size_t all = size() + (varied_ ? 1 : 0);
  for (std::size_t first = 0, count = all; first < all;) {
    count = std::min(count, all - first);
    std::vector<variations::Direction> directions(count);
    if (varied_ && first + count == all) directions.back() = {{*varied_, 1}};
    try {
      parts_.push_back({first, count, variations::VariedMotion(scene, directions, {}, tolerance)});
      first += count;
    } catch (const tape::TooManyOperations&) {
      if (count == 1) throw;
      count = (count + 1) / 2;
    }
  }
}

std::vector<double> Motion::values(const tape::Formula& formula, std::span<const double> x, double t) const {
  std::vector<double> all(x.begin(), x.end()), found(formula.outputs());
  all.insert(all.end(), equations_->parameters.begin(), equations_->parameters.end());
  formula.evaluate(all.data(), t, found.data());
  return found;
}

std::vector<double> Motion::energy_gradient(std::span<const double> x, double t) const {
  return values(energy_gradient_, x, t);
}

double Motion::divergence(std::span<const double> x, double t) {
  if (!divergence_) {
    try {
      divergence_ = divergence_of(*equations_);
    } catch (const tape::TooManyOperations&) {
      divergence_ = variations::formula_of(*equations_, {Symbol(std::numeric_limits<double>::quiet_NaN())});
    }
  }
  return values(*divergence_, x, t)[0];
}

bool Motion::go_to(variations::VariedMotion& motion, double end, Effort& effort, std::string& reason) const {
  while (end > std::max(motion.reach(), motion.time())) {
    if (!effort.go()) {
      reason = effort.why();
      return false;
    }
    if (!motion.advance(end)) break;
  }
  if (end <= std::max(motion.reach(), motion.time()) && motion.look(end)) return true;
  reason = "the motion cannot be followed beyond t = " + messages::number(equations_->sign_of_time() * motion.time());
  return false;
}

std::optional<Reached> Motion::follow(std::span<const double> x, double t, double dt, Effort& effort,
                                      std::string& reason) {
  const std::size_t n = size();
  Reached made{{}, Matrix(n, n), std::vector<double>(varied_ ? n : 0)};
  for (Part& part : parts_) {
    variations::Derivatives beginning;
    beginning.first.assign(part.count * n, 0);
    for (std::size_t d = 0; d < part.count; ++d)
      if (part.first + d < n) beginning.first[d * n + part.first + d] = 1;
    part.motion.start(x, beginning, t);
    if (!effort.go() || !go_to(part.motion, t + dt, effort, reason)) {
      if (reason.empty()) reason = effort.why();
      return std::nullopt;
    }
    const std::vector<double> slopes = part.motion.derivatives().first;
    if (!std::ranges::all_of(slopes, [](double slope) { return std::isfinite(slope); })) {
      reason = "differences of the motion grow beyond any number";
      return std::nullopt;
    }
    for (std::size_t d = 0; d < part.count; ++d)
      for (std::size_t i = 0; i < n; ++i)
        (part.first + d < n ? made.by_start(i, part.first + d) : made.by_parameter[i]) = slopes[d * n + i];
    if (part.first == 0) made.state.assign(part.motion.state().begin(), part.motion.state().end());
  }
  return made;
}

std::vector<std::vector<double>> Motion::path(std::span<const double> x, double t, std::span<const double> times,
                                              Effort& effort, std::string& reason) {
  std::vector<std::vector<double>> states;
  states.reserve(times.size());
  alone_.start(x, {}, t);
  for (const double at : times) {
    if (!go_to(alone_, at, effort, reason)) break;
    states.emplace_back(alone_.state().begin(), alone_.state().end());
  }
  return states;
}

}  // namespace least::periodic
