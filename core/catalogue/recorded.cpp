#include "core/catalogue/recorded.hpp"

#include "core/from_values.hpp"
#include "core/parameters.hpp"
#include "core/problem.hpp"
#include "core/schemes/taylor.hpp"
#include "core/tape/symbol.hpp"
#include "least_problems.hpp"

namespace least {
namespace {

using text::FormKind;

/// Recording records one problem on the tape of a form. Plain is the problem with numbers as parameters, whose concepts
/// tell which mechanics it is. Backward, −t, −p and −s replace t, p and s.
template <class Plain, class P>
class Recording {
 public:
  Recording(std::shared_ptr<text::Form> form, const P& problem, bool backward)
      : problem_(problem), backward_(backward), form_(std::move(form)) {}

  std::shared_ptr<const text::Form> form(const ProblemCard& card) {
    if constexpr (Flow<Plain>) {
      record_flow();
    } else {
      record_mechanics();
    }
    form_->autonomous = Autonomous<Plain>;
    form_->keeps_energy = KeepsEnergy<Plain> && !Flow<Plain>;
    for (std::size_t i = 0; i < form_->invariants.size(); ++i)
      form_->invariant_names.push_back(card.invariants[i].name);
    return form_;
  }

 private:
  Symbol variable(std::size_t i) { return Symbol::variable(form_->tape, i); }
  Symbol turned(const Symbol& x) const { return backward_ ? -x : x; }
  Symbol time() { return turned(Symbol::time(form_->tape)); }

  void record_flow() {
    form_->kind = FormKind::flow;
    form_->coordinates = Plain::dim;
    Point<Plain::dim, Symbol, Symbol> x;
    x.t = time();
    for (std::size_t i = 0; i < Plain::dim; ++i) x[i] = variable(i);
    for (const Symbol& rate : problem_.field(x.y, phase(problem_, x.t))) form_->rates.push_back(turned(rate));
    record_invariants(x);
  }

  void record_mechanics() {
    form_->coordinates = Plain::dof;
    State<Plain::dof, Symbol, Symbol> x;
    x.t = time();
    for (std::size_t i = 0; i < Plain::dof; ++i) {
      x.q[i] = variable(i);
      x.p[i] = turned(variable(static_cast<std::size_t>(form_->numbers.momentum) + i));
    }
    const auto now = phase(problem_, x.t);
    if constexpr (Potential<Plain>) {
      form_->kind = LinearContact<Plain>         ? FormKind::contact_linear
                    : QuadraticContact<Plain>    ? FormKind::contact_quadratic
                    : ConfigurationMetric<Plain> ? FormKind::metric
                                                 : FormKind::separable;
      form_->potential = problem_.potential(x.q, now);
      if constexpr (ConfigurationMetric<Plain>) {
        const auto metric = problem_.metric(x.q);
        form_->metric = text::SymbolMatrix(Plain::dof);
        for (std::size_t i = 0; i < Plain::dof; ++i)
          for (std::size_t j = 0; j < Plain::dof; ++j)
            if (!text::is_nothing(metric[i][j])) form_->metric.row(i).push_back({j, metric[i][j]});
      } else {
        form_->mass.assign(Plain::dof, Symbol(1));
        if constexpr (HasInverseMass<Plain>) {
          const auto inverse = problem_.inverse_mass();
          for (std::size_t i = 0; i < Plain::dof; ++i) form_->mass[i] = Symbol(1) / Symbol(inverse[i]);
        }
      }
      if constexpr (ConstantDamping<Plain>) {
        form_->damping = turned(Symbol(problem_.damping()));
      } else if constexpr (LinearContact<Plain>) {
        form_->damping = turned(problem_.damping(now));
      }
      if constexpr (QuadraticContact<Plain>) {
        form_->action_curvature = problem_.action_curvature();
        form_->offset = problem_.offset();
      }
      form_->constant_damping = ConstantDamping<Plain>;
      form_->reads_action = QuadraticContact<Plain>;
    } else {
      form_->kind = FormKind::hamiltonian;
      form_->hamiltonian =
          problem_.hamiltonian(x.q, x.p, turned(variable(static_cast<std::size_t>(form_->numbers.action))), now);
      form_->reads_action = problem_.reads_action();
    }
    record_invariants(x);
  }

  template <class X>
  void record_invariants(const X& x) {
    if constexpr (HasInvariants<Plain>)
      for (const Symbol& value : invariants_at(problem_, x)) form_->invariants.push_back(value);
  }

  const P& problem_;
  bool backward_;
  std::shared_ptr<text::Form> form_;
};

/// numbered returns a form with nothing but the numbering of its variables.
template <class P>
std::shared_ptr<text::Form> numbered() {
  auto form = std::make_shared<text::Form>();
  if constexpr (Flow<P>) {
    form->numbers = text::Numbering::of_flow(P::dim);
  } else {
    form->numbers = text::Numbering::of_mechanics(P::dof);
  }
  return form;
}

template <template <class> class P>
std::shared_ptr<const text::Form> recorded(const ProblemCard& card, std::span<const double> parameters, bool backward) {
  const auto problem = from_values<P<double>>(About<P>::fields, parameters);
  return Recording<P<double>, P<double>>(numbered<P<double>>(), problem, backward).form(card);
}
std::shared_ptr<const text::Form> recorded(const ProblemCard& card, std::span<const double> parameters, bool backward) {
#define LEAST_RECORDED(name, Class) \
  if (card.id == #name) return recorded<problems::Class>(card, parameters, backward);
  LEAST_FOR_EACH_PROBLEM(LEAST_RECORDED)
#undef LEAST_RECORDED
  return nullptr;
}

/// in_variables returns the problem of a scene with variables in place of the parameters that are `varied`, by their
/// indices on the card.
template <template <class> class P, class Variable>
P<Symbol> in_variables(const Scene& scene, const std::vector<bool>& varied, Variable&& variable) {
  auto problem = parameters::in<Symbol>(from_values<P<double>>(About<P>::fields, scene.parameters));
  parameters::for_each_number<P>([&](const Field<P<double>>& field) {
    const auto& cards = scene.card().parameters;
    const auto place =
        static_cast<std::size_t>(std::ranges::find(cards, field.name, &ParameterCard::name) - cards.begin());
    if (varied[place]) parameters::with_member(problem, field, [&](Symbol& member) { member = variable(place); });
  });
  return problem;
}

template <template <class> class P>
std::shared_ptr<const text::Form> recorded_in_parameters(const Scene& scene, const std::vector<bool>& varied,
                                                         bool backward) {
  auto form = numbered<P<double>>();
  const auto problem = in_variables<P>(scene, varied, [&](std::size_t place) {
    return Symbol::variable(form->tape, static_cast<std::size_t>(form->numbers.parameter) + place);
  });
  return Recording<P<double>, P<Symbol>>(std::move(form), problem, backward).form(scene.card());
}

template <template <class> class P>
std::optional<tape::Program> recorded_equations(const Scene& scene, const std::vector<bool>& varied) {
  using X = StateOf<P<double>>;
  constexpr std::size_t size = X::size;
  tape::Tape tape;
  std::vector<tape::Index> rates;
  const auto write = [&](const auto& problem) {
    typename X::template in<Symbol, Symbol> x;
    for (std::size_t i = 0; i < size; ++i) x[i] = Symbol::variable(tape, i);
    x.t = Symbol::time(tape);
    const auto rate = derivative(problem, x);
    for (std::size_t i = 0; i < size; ++i) rates.push_back(rate[i].on(tape));
  };
  const std::ptrdiff_t count = std::ranges::count(varied, true);
  if (count == 0) {
    write(from_values<P<double>>(About<P>::fields, scene.parameters));
  } else {
    write(in_variables<P>(scene, varied, [&](std::size_t place) {
      const auto before = std::count(varied.begin(), varied.begin() + static_cast<std::ptrdiff_t>(place), true);
      return Symbol::variable(tape, size + static_cast<std::size_t>(before));
    }));
    rates.insert(rates.end(), static_cast<std::size_t>(count), Symbol(0).on(tape));
  }
  return taylor::program_of(tape, rates, size);
}

}  // namespace

std::optional<text::TextScene> recorded_text(const ProblemCard& problem, std::span<const double> parameters,
                                             bool backward) {
  auto form = recorded(problem, parameters, backward);
  if (!form) return std::nullopt;
  text::Definition definition;
  definition.kind = text::Definition::Kind::equations;
  for (std::size_t i = 0; i < form->coordinates; ++i) definition.variables.push_back(problem.variables[i].name);
  return text::TextScene::of(std::move(definition), std::move(form));
}

std::shared_ptr<const text::Form> recorded_in_parameters(const Scene& scene, const std::vector<bool>& varied,
                                                         bool backward) {
  const std::string& id = scene.card().id;
#define LEAST_RECORDED(name, Class) \
  if (id == #name) return recorded_in_parameters<problems::Class>(scene, varied, backward);
  LEAST_FOR_EACH_PROBLEM(LEAST_RECORDED)
#undef LEAST_RECORDED
  return nullptr;
}

std::optional<tape::Program> recorded_equations(const Scene& scene, const std::vector<bool>& varied) {
  const std::string& id = scene.card().id;
#define LEAST_RECORDED(name, Class) \
  if (id == #name) return recorded_equations<problems::Class>(scene, varied);
  LEAST_FOR_EACH_PROBLEM(LEAST_RECORDED)
#undef LEAST_RECORDED
  return std::nullopt;
}

}  // namespace least
