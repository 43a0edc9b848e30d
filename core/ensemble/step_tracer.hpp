// Traces a step of the problem P, whose parameters may be recording numbers.
#pragma once

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <string>

#include "core/ensemble/lane_schemes.hpp"
#include "core/ensemble/square.hpp"
#include "core/ensemble/step_trace.hpp"
#include "core/ensemble/traced.hpp"
#include "core/exact/elements.hpp"
#include "core/problem_traits.hpp"

namespace least {

/// StepTracer fills a StepTrace: its constructor traces start conditions and columns, trace_steps the step.
template <class P>
class StepTracer {
 public:
  /// `capacity` is the number of degrees of freedom, or variables of a flow, that the card has room for.
  StepTracer(const Request& request, const P& problem, std::size_t capacity, bool full, StepTrace& made)
      : card_(request.scene->card()),
        problem_(problem),
        capacity_(capacity),
        full_(full),
        made_(made),
        trace_(made.trace) {
    x_.t = Traced::time(trace_);
    for (std::size_t i = 0; i < X::size; ++i)
      if (const auto row = row_of(i)) {
        x_[i] = Traced::variable(trace_, made.rows.size());
        made.rows.push_back(*row);
        components_.push_back(i);
      }
    // Where the motion does not need s, s is the last variable and not part of the state.
    if constexpr (LinearContact<P>)
      if (!full) x_.action.s = Traced::variable(trace_, made.rows.size());
    trace_start();
    for (const std::size_t column : request.columns) trace_column(card_.columns[column].name);
    made_.values_end = trace_.size();
  }

  /// trace_steps returns whether the step could be traced.
  template <class Scheme>
  bool trace_steps(const Scheme& scheme, double step) {
    if constexpr (requires { typename StepperOf<Scheme, P, X>; }) {
      constexpr bool with_pole = QuadraticContact<P> && !OfRatesAlone<Scheme>;
      if (!with_pole) made_.pole = -1;
      trace_.make_room();  // writing within a step must not throw
      auto stepper = scheme.bind(problem_, x_);
      made_.forces_at_start = stepper.work().forces;
      X x = x_;
      made_.begin = trace_.size();
      const Traced failed = trace_step<with_pole>(stepper, x, step);
      made_.end = trace_.size();
      made_.forces_of_step = stepper.work().forces - made_.forces_at_start;
      const X after = x;
      trace_step<with_pole>(stepper, x, step);
      if (trace_.full() || (failed.is_constant() && failed.constant() != 0)) return false;
      if (!failed.is_constant()) made_.failed = failed.on(trace_);
      return compare_steps(after);
    }
    return false;
  }

 private:
  using Place = Trace::Place;
  using X = FullStateOf<P, Traced, Traced>;
  static constexpr bool watches_turns = HasFrequency<P> && !ConstantFrequency<P>;

  std::size_t coordinates() const {
    if constexpr (requires { problem_.coordinates(); }) {
      return problem_.coordinates();
    } else if constexpr (Flow<P>) {
      return P::dim;
    } else {
      return P::dof;
    }
  }
  /// row_of returns the place on the card of a component of the state; nothing where the scene does not have it.
  std::optional<std::uint32_t> row_of(std::size_t i) const {
    const std::size_t n = coordinates();
    if constexpr (Flow<P>) {
      return i < n ? std::optional(static_cast<std::uint32_t>(i)) : std::nullopt;
    } else {
      constexpr std::size_t half = P::dof;
      if (i == 2 * half) return has_action() ? std::optional(static_cast<std::uint32_t>(2 * capacity_)) : std::nullopt;
      if (i % half >= n) return std::nullopt;
      return static_cast<std::uint32_t>(i < half ? i : capacity_ + i - half);
    }
  }
  bool has_action() const {
    if constexpr (LinearContact<P>) return full_;
    if constexpr (GeneralHamiltonian<P>) return problem_.reads_action();
    return QuadraticContact<P>;
  }
  bool has_energy() const { return HasEnergy<P> && (!LinearContact<P> || full_); }

  void trace_start() {
    const X slope = derivative(problem_, x_);
    for (const std::size_t i : components_) made_.start.push_back(slope[i].on(trace_));
    if constexpr (HasEnergy<P>)
      if (has_energy()) made_.start.push_back(energy(problem_, x_).on(trace_));
    if constexpr (QuadraticContact<P>) made_.pole = reaches_pole(x_, Traced::step(trace_)).on.on(trace_);
    if constexpr (HasDomain<P>)
      if (problem_.bounded()) made_.inside = Traced(problem_.inside(position(x_))).on(trace_);
    if constexpr (HasFrequency<P>) {
      made_.turn = Traced(problem_.frequency_squared(position(x_))).on(trace_);
      made_.turn_is_fixed = !watches_turns;
      if constexpr (ConstantDamping<P>) made_.damping = Traced(problem_.damping()).on(trace_);
      if constexpr (watches_turns) {
        turn_limit_ = Traced::unfolded(trace_, std::numeric_limits<double>::infinity());
        made_.turn_limit = turn_limit_.on(trace_);
      }
    }
  }

  void trace_column(const std::string& name) {
    for (const VariableCard& variable : card_.variables)
      if (variable.angle && name == variable.name + "_wrapped") {
        made_.wrapped.push_back(made_.columns.size());
        return trace_column(variable.name);
      }
    if constexpr (TwoBody<P> || requires { problem_.gravitational_parameter(); }) {
      const auto names = std::span(two_body::element_names).first(two_body::elements_in<P::dof>);
      const auto element = std::ranges::find(names, name);
      if (element != names.end() && !is_invariant(name)) {
        made_.elements.emplace_back(made_.columns.size(), element - names.begin());
        trace_orbit();
        made_.columns.push_back(trace_.constant(unknown));
        return;
      }
    }
    made_.columns.push_back(column_value(name).on(trace_));
  }
  bool is_invariant(const std::string& name) const {
    return std::ranges::find(card_.invariants, name, &QuantityCard::name) != card_.invariants.end();
  }
  void trace_orbit() {
    if (!made_.orbit.empty()) return;
    for (const Traced& q : x_.q) made_.orbit.push_back(q.on(trace_));
    for (const Traced& p : x_.p) made_.orbit.push_back(p.on(trace_));
    made_.orbit.push_back(Traced(problem_.gravitational_parameter()).on(trace_));
  }
  Traced column_value(const std::string& name) const {
    if (name == "t") return x_.t;
    for (std::size_t k = 0; k < components_.size(); ++k)
      if (card_.variables[made_.rows[k]].name == name) return x_[components_[k]];
    if constexpr (HasEnergy<P>)
      if (name == "energy" && has_energy()) return energy(problem_, x_);
    if constexpr (Contact<P>)
      if (name == "mechanical_energy") return mechanical_energy(problem_, x_.q, x_.p, phase(problem_, x_.t));
    if constexpr (HasInvariants<P>)
      for (std::size_t k = 0; k < card_.invariants.size(); ++k)
        if (card_.invariants[k].name == name) return invariants_at(problem_, x_)[k];
    if constexpr (HasQuantities<P>)
      for (std::size_t k = 0; k < card_.quantities.size(); ++k)
        if (card_.quantities[k].name == name) return problem_.quantities(x_.y, x_.t)[k];
    return unknown;
  }
  /// reaches_pole: −γ s h > 2 in a scene with γs²/2, whose step then reaches the pole of ṡ = −γs²/2.
  Traced::Mask reaches_pole(const X& x, const Traced& h) const requires QuadraticContact<P> {
    return -(problem_.action_curvature() * x.action.s * h) > Traced(2);
  }

  /// turns_too_fast: ω² is above its limit. Squares are compared as fractions, which needs no roots or quotients.
  Traced::Mask turns_too_fast(const X& x) const requires watches_turns {
    std::array<Square<Traced>, std::tuple_size_v<std::remove_cvref_t<decltype(position(x))>>> q;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = position(x)[i];
    const Square<Traced> turn = problem_.frequency_squared(q);
    return turn.plain ? turn.value > turn_limit_ : turn.over > turn_limit_ * turn_limit_ * turn.under;
  }

  /// trace_step takes one step and returns its StepFailure.
  template <bool WithPole, class Stepper>
  Traced trace_step(Stepper& stepper, X& x, double step) {
    x.t = Traced::time(trace_);
    TracedStatus status = stepper.step(x, Traced::step(trace_));
    if constexpr (WithPole) all_failed(status, reaches_pole(x, step), StepStatus::singular);
    Traced failed = 0;
    const auto add = [&](const Traced::Mask& where, StepFailure why) {
      const bool first = failed.is_constant() && failed.constant() == 0;
      const Traced code = static_cast<double>(why);
      failed = first ? where.on * code : select(where, code, failed);
    };
    if constexpr (watches_turns) add(turns_too_fast(x), StepFailure::unstable);
    if constexpr (HasDomain<P>)
      if (problem_.bounded()) add(!(Traced(problem_.inside(position(x))) >= Traced(0)), StepFailure::left_domain);
    add({status.failed}, StepFailure::singular);
    return failed;
  }

  /// compare_steps checks that a second step is the first with other inputs, and pairs the values that the first step
  /// read from before with those that the second read from the first.
  bool compare_steps(const X& after) {
    const auto& nodes = trace_.nodes();
    const Place length = made_.end - made_.begin;
    if (trace_.size() < made_.end + length) return false;
    std::map<Place, Place> kept;
    for (const std::size_t i : components_) {
      if (after[i].is_constant()) return false;
      made_.state.push_back(after[i].on(trace_));
    }
    const auto agree = [&](Place one, Place other) {
      if (one < 0 || one >= made_.begin) return other == (one < 0 ? one : one + length);
      const Trace::Node& node = nodes[static_cast<std::size_t>(one)];
      if (node.kind == Trace::Kind::variable && static_cast<std::size_t>(node.a) < made_.state.size())
        return other == made_.state[static_cast<std::size_t>(node.a)];
      if (node.kind != Trace::Kind::operation) return node.kind == Trace::Kind::variable || other == one;
      return kept.try_emplace(one, other).first->second == other && other < made_.end;
    };
    for (Place i = made_.begin; i < made_.end; ++i) {
      const Place twin = i + length;
      const auto &one = nodes[static_cast<std::size_t>(i)], &other = nodes[static_cast<std::size_t>(twin)];
      if (one.kind != other.kind || one.code != other.code) return false;
      if (one.kind == Trace::Kind::constant) {
        const auto bits = [&](const Trace::Node& node) {
          return std::bit_cast<std::uint64_t>(trace_.constants()[static_cast<std::size_t>(node.a)]);
        };
        if (bits(one) != bits(other)) return false;
      } else if (!agree(one.a, other.a) || !agree(one.b, other.b) || !agree(one.c, other.c)) {
        return false;
      }
    }
    made_.kept.assign(kept.begin(), kept.end());
    return true;
  }

  const ProblemCard& card_;
  P problem_;
  std::size_t capacity_;
  bool full_;
  StepTrace& made_;
  Trace& trace_;
  X x_;
  Traced turn_limit_;                    ///< limit of ω²
  std::vector<std::size_t> components_;  ///< the components of the state that the scene has
};

}  // namespace least
