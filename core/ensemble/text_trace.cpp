#include "core/ensemble/text_trace.hpp"

#include <bit>
#include <map>

#include "core/ensemble/lane_schemes.hpp"
#include "core/ensemble/traced.hpp"
#include "core/problem_traits.hpp"
#include "core/text/scene.hpp"
#include "core/text/scenes.hpp"

namespace least {
namespace {

using Place = Trace::Place;

template <class P>
class TextTracer {
 public:
  TextTracer(const Request& request, std::span<const double> parameters, bool full, TextTrace& made)
      : request_(request), text_(*request.scene->mechanics->text()), full_(full), made_(made), trace_(made.trace) {
    problem_.formulas = std::make_shared<const text::Formulas>(*text_.form, parameters);
    x_.t = Traced::time(trace_);
    for (std::size_t i = 0; i < X::size; ++i)
      if (const auto row = row_of(i)) {
        x_[i] = Traced::variable(trace_, made.rows.size());
        made.rows.push_back(*row);
        components_.push_back(i);
      }
    // Where the motion does not need s, it stands behind all others and is not part of the state.
    if constexpr (LinearContact<P>)
      if (!full) x_.action.s = Traced::variable(trace_, made.rows.size());
    trace_values();
  }

  /// Whether it was possible.
  template <class Scheme>
  bool trace_steps(const Scheme& scheme, double step) {
    if constexpr (requires { typename StepperOf<Scheme, P, X>; }) {
      auto stepper = scheme.bind(problem_, x_);
      made_.forces_at_start = stepper.work().forces;
      X x = x_;
      made_.begin = trace_.size();
      const Traced failed = trace_step(stepper, x, step);
      made_.end = trace_.size();
      made_.forces_of_step = stepper.work().forces - made_.forces_at_start;
      const X after = x;
      trace_step(stepper, x, step);
      if (trace_.full() || (failed.is_constant() && failed.constant() != 0)) return false;
      if (!failed.is_constant()) made_.failed = failed.on(trace_);
      return compare_steps(after);
    }
    return false;
  }

 private:
  using X = FullStateOf<P, Traced, Traced>;

  /// Of a component of the state: its place on the card, where the scene has it.
  std::optional<std::uint32_t> row_of(std::size_t i) const {
    const auto n = text_.form->coordinates, capacity = static_cast<std::size_t>(text_.capacity);
    if constexpr (Flow<P>) return i < n ? std::optional(static_cast<std::uint32_t>(i)) : std::nullopt;
    constexpr std::size_t half = text::compiled_coordinates;
    if (i == 2 * half) {
      const bool moves = LinearContact<P> ? full_ : QuadraticContact<P> || text_.form->reads_action;
      return moves ? std::optional(static_cast<std::uint32_t>(2 * capacity)) : std::nullopt;
    }
    if (i % half >= n) return std::nullopt;
    return static_cast<std::uint32_t>(i < half ? i : capacity + i - half);
  }

  void trace_values() {
    const X slope = derivative(problem_, x_);
    for (const std::size_t i : components_) made_.start.push_back(slope[i].on(trace_));
    const bool has_energy = !LinearContact<P> || full_;
    if constexpr (HasEnergy<P>)
      if (has_energy) made_.start.push_back(energy(problem_, x_).on(trace_));
    if constexpr (QuadraticContact<P>) made_.pole = reaches_pole(x_, Traced::step(trace_)).on.on(trace_);
    const auto& cards = request_.scene->card().columns;
    for (const std::size_t column : request_.columns)
      made_.columns.push_back(column_value(cards[column].name, has_energy).on(trace_));
    made_.values_end = trace_.size();
  }
  Traced column_value(const std::string& name, bool has_energy) const {
    const ProblemCard& card = request_.scene->card();
    if (name == "t") return x_.t;
    for (std::size_t k = 0; k < components_.size(); ++k)
      if (card.variables[made_.rows[k]].name == name) return x_[components_[k]];
    if constexpr (HasEnergy<P>)
      if (name == "energy" && has_energy) return energy(problem_, x_);
    if constexpr (Contact<P>)
      if (name == "mechanical_energy") return mechanical_energy(problem_, x_.q, x_.p, x_.t);
    for (std::size_t k = 0; k < card.invariants.size(); ++k)
      if (card.invariants[k].name == name) return invariants_at(problem_, x_)[k];
    return unknown;
  }
  /// −γ s h > 2, where H has γs²/2: a step reaches the pole of ṡ = −γs²/2.
  Traced::Mask reaches_pole(const X& x, const Traced& h) const requires QuadraticContact<P> {
    return -(problem_.action_curvature() * x.action.s * h) > Traced(2);
  }

  template <class Stepper>
  Traced trace_step(Stepper& stepper, X& x, double step) {
    x.t = Traced::time(trace_);
    TracedStatus status = stepper.step(x, Traced::step(trace_));
    if constexpr (QuadraticContact<P>) all_failed(status, reaches_pole(x, step), StepStatus::singular);
    return status.failed;
  }

  /// The second step is the first with other numbers: those that the first one found, and the second one has from it.
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

  const Request& request_;
  const text::TextScene& text_;
  bool full_;
  TextTrace& made_;
  Trace& trace_;
  P problem_;
  X x_;
  std::vector<std::size_t> components_;  ///< of the state, that the scene has
};

}  // namespace

std::optional<TextTrace> trace_text(const Request& request, std::span<const double> parameters, std::size_t scheme,
                                    bool full) {
  using text::FormKind;
  const text::Form& form = *request.scene->mechanics->text()->form;
  if (!form.is_compiled()) return std::nullopt;
  std::optional<TextTrace> made(std::in_place);
  const auto as = [&]<class P>(P*) {
    TextTracer<P> tracer(request, parameters, full, *made);
    bool good = false;
    with_lane_scheme(scheme, request.settings, [&](const auto& s) { good = tracer.trace_steps(s, s.step); });
    if (!good) made.reset();
  };
  // Forms that differ in nothing but what they can be asked for are one here.
  constexpr int n = text::compiled_coordinates;
  if (form.kind == FormKind::separable) as(static_cast<text::SeparableScene<n, true>*>(nullptr));
  if (form.kind == FormKind::contact_linear && form.constant_damping)
    as(static_cast<text::DampedScene<n, true>*>(nullptr));
  if (form.kind == FormKind::contact_linear && !form.constant_damping)
    as(static_cast<text::TimedDampedScene<n>*>(nullptr));
  if (form.kind == FormKind::contact_quadratic) as(static_cast<text::QuadraticScene<n>*>(nullptr));
  if (form.kind == FormKind::metric) as(static_cast<text::MetricScene<n>*>(nullptr));
  if (form.kind == FormKind::hamiltonian) as(static_cast<text::HamiltonianScene*>(nullptr));
  if (form.kind == FormKind::flow) as(static_cast<text::FlowScene*>(nullptr));
  if (form.kind == FormKind::lagrangian) made.reset();
  return made;
}

}  // namespace least
