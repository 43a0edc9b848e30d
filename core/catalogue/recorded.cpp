#include "core/catalogue/recorded.hpp"

#include "core/from_values.hpp"
#include "core/problem.hpp"
#include "core/tape/symbol.hpp"
#include "least_problems.hpp"

namespace least {
namespace {

using text::FormKind;

/// Records one problem on the tape of a form, with −t, −p and −s in the place of t, p and s.
template <class P>
class Recording {
 public:
  explicit Recording(const P& problem) : problem_(problem) {}

  std::shared_ptr<const text::Form> form(const ProblemCard& card) {
    if constexpr (Flow<P>) {
      record_flow();
    } else {
      record_mechanics();
    }
    form_->autonomous = Autonomous<P>;
    form_->keeps_energy = KeepsEnergy<P> && !Flow<P>;
    for (std::size_t i = 0; i < form_->invariants.size(); ++i)
      form_->invariant_names.push_back(card.invariants[i].name);
    return form_;
  }

 private:
  Symbol variable(std::size_t i) { return Symbol::variable(form_->tape, i); }
  Symbol time() { return -Symbol::time(form_->tape); }

  void record_flow() {
    form_->kind = FormKind::flow;
    form_->coordinates = P::dim;
    form_->numbers = text::Numbering::of_flow(P::dim);
    Point<P::dim, Symbol, Symbol> x;
    x.t = time();
    for (std::size_t i = 0; i < P::dim; ++i) x[i] = variable(i);
    for (const Symbol& rate : problem_.field(x.y, phase(problem_, x.t))) form_->rates.push_back(-rate);
    record_invariants(x);
  }

  void record_mechanics() {
    form_->coordinates = P::dof;
    form_->numbers = text::Numbering::of_mechanics(P::dof);
    State<P::dof, Symbol, Symbol> x;
    x.t = time();
    for (std::size_t i = 0; i < P::dof; ++i) {
      x.q[i] = variable(i);
      x.p[i] = -variable(static_cast<std::size_t>(form_->numbers.momentum) + i);
    }
    const auto now = phase(problem_, x.t);
    if constexpr (Potential<P>) {
      form_->kind = LinearContact<P>         ? FormKind::contact_linear
                    : QuadraticContact<P>    ? FormKind::contact_quadratic
                    : ConfigurationMetric<P> ? FormKind::metric
                                             : FormKind::separable;
      form_->potential = problem_.potential(x.q, now);
      if constexpr (ConfigurationMetric<P>) {
        for (const auto& row : problem_.metric(x.q))
          for (const Symbol& entry : row) form_->metric.push_back(entry);
      } else {
        form_->mass.assign(P::dof, Symbol(1));
        if constexpr (HasInverseMass<P>) {
          const auto inverse = problem_.inverse_mass();
          for (std::size_t i = 0; i < P::dof; ++i) form_->mass[i] = Symbol(1) / Symbol(inverse[i]);
        }
      }
      if constexpr (ConstantDamping<P>) {
        form_->damping = -Symbol(problem_.damping());
      } else if constexpr (LinearContact<P>) {
        form_->damping = -problem_.damping(now);
      }
      if constexpr (QuadraticContact<P>) {
        form_->action_curvature = problem_.action_curvature();
        form_->offset = problem_.offset();
      }
      form_->constant_damping = ConstantDamping<P>;
      form_->reads_action = QuadraticContact<P>;
    } else {
      form_->kind = FormKind::hamiltonian;
      form_->hamiltonian =
          problem_.hamiltonian(x.q, x.p, -variable(static_cast<std::size_t>(form_->numbers.action)), now);
      form_->reads_action = problem_.reads_action();
    }
    record_invariants(x);
  }

  template <class X>
  void record_invariants(const X& x) {
    if constexpr (HasInvariants<P>)
      for (const Symbol& value : invariants_at(problem_, x)) form_->invariants.push_back(value);
  }

  const P& problem_;
  std::shared_ptr<text::Form> form_ = std::make_shared<text::Form>();
};

template <template <class> class P>
std::shared_ptr<const text::Form> recorded(const Scene& scene) {
  const auto problem = from_values<P<double>>(About<P>::fields, scene.parameters);
  return Recording<P<double>>(problem).form(scene.card());
}

}  // namespace

std::shared_ptr<const text::Form> recorded_backward(const Scene& scene) {
  const std::string& id = scene.card().id;
#define LEAST_RECORDED(name, Class) \
  if (id == #name) return recorded<problems::Class>(scene);
  LEAST_FOR_EACH_PROBLEM(LEAST_RECORDED)
#undef LEAST_RECORDED
  return nullptr;
}

}  // namespace least
