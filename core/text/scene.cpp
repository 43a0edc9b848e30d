#include "core/text/scene.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/memory_budget.hpp"
#include "core/tape/formula.hpp"
#include "core/text/expansion.hpp"
#include "core/text/folding.hpp"
#include "core/text/formula_markup.hpp"
#include "core/text/lift.hpp"
#include "core/text/scenes.hpp"
#include "core/text/sized_scene.hpp"

namespace least::text {
namespace {

constexpr double default_span = 20;

std::string number_text(double x) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.begin(), digits.end(), x).ptr};
}

/// entries_of returns the stored entries of a matrix, row by row.
std::vector<Symbol> entries_of(const SymbolMatrix& matrix) {
  std::vector<Symbol> all;
  for (std::size_t i = 0; i < matrix.size(); ++i)
    for (const auto& entry : matrix.row(i)) all.push_back(entry.value);
  return all;
}

}  // namespace

std::variant<TextScene, std::vector<DefinitionFault>> TextScene::read(Definition definition) {
  auto form = form_of(definition);
  if (auto* faults = std::get_if<std::vector<DefinitionFault>>(&form)) return std::move(*faults);
  return of(std::move(definition), std::get<std::shared_ptr<const Form>>(form));
}

TextScene TextScene::of(Definition definition, std::shared_ptr<const Form> form) {
  const int capacity = static_cast<int>(form->coordinates);
  return {std::move(definition), std::move(form), capacity, {}, {}, std::make_shared<SizedScenes>()};
}

std::shared_ptr<const SizedScene> TextScene::sized(std::span<const double> parameters) const {
  if (!known || forward) return made->with(*form, parameters);
  // Not charged to the request: a problem of the catalogue stays in memory when the request is over
  const HeldByThread nobody(nullptr);
  return made->with(*form, parameters);
}

ProblemCard TextScene::described() const {
  ProblemCard card;
  card.id = "custom";
  card.title = definition.title.empty() ? "A scene of your own" : definition.title;
  card.summary = "Given as text with the request.";
  card.formula = formula_of(definition);
  const bool flow = form->kind == FormKind::flow;
  const auto add = [&](const std::string& name, const std::string& doc) {
    card.variables.push_back({name, name, "1", doc, 0});
  };
  for (const auto& name : definition.variables) add(name, flow ? "variable" : "coordinate");
  if (!flow) {
    for (const auto& name : definition.variables) add(momentum_name(name), "momentum of " + name);
    const bool acting = form->kind == FormKind::contact_linear || form->kind == FormKind::contact_quadratic ||
                        form->kind == FormKind::hamiltonian || form->kind == FormKind::lagrangian;
    const bool rests = !form->reads_action && form->kind != FormKind::contact_linear;
    if (acting && !rests) {
      add("s", "action");
      // Of a general H: L, if s only adds friction to it and q and p move without s
      const Symbol& found = form->lagrangian;
      const bool damped = form->kind == FormKind::hamiltonian && !(found.is_constant() && found.constant() == 0);
      card.variables.back().optional = !form->reads_action || damped;
    }
  }
  for (const auto& parameter : definition.parameters)
    card.parameters.push_back(ParameterCard{.name = parameter.first,
                                            .symbol = parameter.first,
                                            .unit = "1",
                                            .doc = "parameter",
                                            .value = parameter.second,
                                            .range = anywhere});
  card.span = default_span;
  for (const auto& name : form->invariant_names) card.invariants.push_back({name, name, "kept, as the text says"});
  if (form->kind == FormKind::hamiltonian && !form->forced) {
    card.lift_objection = Lift::objection(*form, definition.variables);
    if (card.lift_objection.empty()) card.lift = Lift::is_linear(*form) ? Lifted::exactly : Lifted::yes;
  }
  if (known) describe_as_known(card);
  return card;
}

void TextScene::describe_as_known(ProblemCard& card) const {
  card.id = known->id;
  card.title = known->title;
  card.summary = known->summary;
  card.formula = known->formula;
  card.parameters = known->parameters;
  card.span = known->span;
  card.suggested = known->suggested;
  card.presets = known->presets;
  card.references = known->references;
  card.quantities = known->quantities;
  const std::size_t n = form->coordinates, all = form->kind == FormKind::flow ? n : 2 * n;
  for (std::size_t i = 0; i < all; ++i)
    card.variables[i < n ? i : static_cast<std::size_t>(capacity) + i - n] = known->variables[i];
}

template <class T>
std::vector<T> TextScene::on_tape(const std::vector<T>& state) const {
  const Numbering& numbers = form->numbers;
  const auto n = static_cast<std::ptrdiff_t>(form->coordinates);
  std::vector<T> x(static_cast<std::size_t>(numbers.parameter), T(0));
  std::copy_n(state.begin(), n, x.begin());
  if (form->kind == FormKind::flow) return x;
  std::copy_n(state.begin() + capacity, n, x.begin() + numbers.momentum);
  if (state.size() > 2 * static_cast<std::size_t>(capacity)) x[static_cast<std::size_t>(numbers.action)] = state.back();
  return x;
}

tape::Formula TextScene::momenta(std::span<const double> parameters) const {
  Folding fold(*form, parameters);
  return fold.formula(form->momenta);
}

template <class T>
void TextScene::make_momenta(const tape::Formula& formula, const T& t, std::vector<T>& state) const {
  const std::vector<T> x = on_tape(state);
  std::vector<T> p(form->coordinates);
  formula.evaluate(x.data(), t, p.data());
  std::copy(p.begin(), p.end(), state.begin() + capacity);
}

void TextScene::velocities_to_momenta(std::span<const double> parameters, double t, std::vector<double>& state) const {
  make_momenta(momenta(parameters), t, state);
}
void TextScene::velocities_to_momenta(std::span<const double> parameters, const Moved& t,
                                      std::vector<Moved>& state) const {
  make_momenta(momenta(parameters), t, state);
}
void TextScene::velocities_to_momenta(const tape::Formula& momenta, double t, std::vector<double>& state) const {
  make_momenta(momenta, t, state);
}

std::optional<TextScene::Objection> TextScene::objection(std::span<const double> parameters) const {
  Folding fold(*form, parameters);
  const bool typed = definition.kind == Definition::Kind::potential;
  const char* whole = definition.kind == Definition::Kind::lagrangian ? "/lagrangian" : "/hamiltonian";
  for (std::size_t i = 0; i < form->mass.size(); ++i) {
    const double mass = fold.number(form->mass[i]);
    const auto& name = definition.variables[i];
    if (mass > 0 && std::isfinite(mass) && std::isfinite(1 / mass)) continue;
    if (typed) return Objection{"/masses/" + name, "is not positive: a mass must be more than 0"};
    return Objection{whole, "is not regular: with these parameters the mass of " + name + " is not positive"};
  }
  const auto too_many = [&] {
    const bool flow = form->kind == FormKind::flow;
    return Objection{typed  ? "/potential"
                     : flow ? "/equations"
                            : whole,
                     "takes too many operations with these parameters"};
  };
  try {
    if (form->full_mass && !is_positive_definite(form->hessian, fold.numbers(entries_of(form->hessian))))
      return Objection{whole, "has a mass that is not positive with these parameters: " + second_derivative() +
                                  " is not positive definite"};
  } catch (const tape::TooManyOperations&) {
    return too_many();
  }
  const auto number = [&](const Symbol& y) {
    const Symbol folded = fold(y);
    return !folded.is_constant() || std::isfinite(folded.constant());
  };
  if (!number(form->damping)) return Objection{typed ? "/damping" : whole, "has a damping that is no finite number"};
  if (!number(form->action_curvature) || !number(form->offset))
    return Objection{typed ? "/action_curvature" : whole, "is no finite number"};
  try {
    sized(parameters);
  } catch (const tape::TooManyOperations&) {
    return too_many();
  }
  return std::nullopt;
}

std::optional<TextScene::Objection> TextScene::objection_to_start(std::span<const double> parameters, double t,
                                                                  const std::vector<double>& state) const {
  if (!form->is_compiled() || form->kind == FormKind::lagrangian) return objection_to_large_start(parameters, t, state);
  const Formulas formulas(*form, parameters);
  const bool flow = form->kind == FormKind::flow;
  const std::size_t n = form->coordinates;
  std::vector<double> x = on_tape(state);
  const char* whole = definition.kind == Definition::Kind::lagrangian    ? "/lagrangian"
                      : definition.kind == Definition::Kind::hamiltonian ? "/hamiltonian"
                                                                         : "/potential";
  if (!form->hessian.empty())
    if (const std::string why = objection_to_masses(parameters, t, x); !why.empty()) return Objection{whole, why};

  const auto finite = [&](const tape::Formula& formula) {
    std::vector<double> values(formula.outputs());
    formula.evaluate(x.data(), t, values.data());
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  const auto unbounded = [&](std::string pointer) { return Objection{std::move(pointer), not_finite_at(t, state)}; };
  if (flow) {
    std::vector<double> rates(n);
    formulas.rates.evaluate(x.data(), t, rates.data());
    for (std::size_t i = 0; i < n; ++i)
      if (!std::isfinite(rates[i])) return unbounded("/equations/" + definition.variables[i]);
    return std::nullopt;
  }
  if (!finite(formulas.damping)) return unbounded(definition.kind == Definition::Kind::potential ? "/damping" : whole);
  for (const auto* part :
       {&formulas.potential, &formulas.gradient, &formulas.metric, &formulas.hamiltonian, &formulas.slopes})
    if (!finite(*part)) return unbounded(whole);
  return std::nullopt;
}

std::optional<TextScene::Objection> TextScene::objection_to_large_start(std::span<const double> parameters, double t,
                                                                        const std::vector<double>& state) const {
  const std::shared_ptr<const SizedScene> made_scene = sized(parameters);
  const SizedScene& scene = *made_scene;
  const char* whole = definition.kind == Definition::Kind::lagrangian    ? "/lagrangian"
                      : definition.kind == Definition::Kind::hamiltonian ? "/hamiltonian"
                                                                         : "/potential";
  std::vector<double> rates(scene.components);
  scene.rate.evaluate(state.data(), t, rates.data());
  if (scene.forced) {
    std::vector<double> forces(scene.coordinates);
    scene.forces.values.evaluate(state.data(), t, forces.data());
    if (!std::ranges::all_of(forces, [](double force) { return std::isfinite(force); }))
      return Objection{definition.forces.empty() ? "/dissipation" : "/forces", not_finite_at(t, state)};
  }
  if (form->kind == FormKind::metric || form->kind == FormKind::lagrangian) {
    std::vector<double> x = on_tape(state), complete = state;
    complete.resize(std::max(complete.size(), scene.moving + scene.found()));
    scene.find_velocities(complete.data(), t);
    if (scene.found() > 0) {
      if (!std::isfinite(complete[scene.moving]))
        return Objection{whole, "has no velocity for the momenta of the start"};
      std::copy_n(complete.begin() + static_cast<std::ptrdiff_t>(scene.moving), scene.found(),
                  x.begin() + form->numbers.momentum);
    }
    if (const std::string why = objection_to_masses(parameters, t, x); !why.empty()) return Objection{whole, why};
  }
  for (std::size_t i = 0; i < rates.size(); ++i)
    if (!std::isfinite(rates[i]))
      return Objection{scene.flow ? "/equations/" + definition.variables[i] : whole, not_finite_at(t, state)};
  return std::nullopt;
}

std::string TextScene::not_finite_at(double t, const std::vector<double>& state) const {
  constexpr std::size_t most = 16;
  std::string detail = "is not finite at the start, or has a derivative that is not: ";
  for (std::size_t i = 0; i < std::min(form->coordinates, most); ++i)
    detail += definition.variables[i] + " = " + number_text(state[i]) + ", ";
  if (form->coordinates > most) detail += "…, ";
  return detail + "t = " + number_text(t);
}

std::string TextScene::second_derivative() const {
  return std::string("its second derivative by the ") +
         (definition.kind == Definition::Kind::lagrangian ? "velocities" : "momenta");
}

std::string TextScene::objection_to_masses(std::span<const double> parameters, double t,
                                           const std::vector<double>& x) const try {
  const std::size_t n = form->coordinates;
  Folding fold(*form, parameters);
  const tape::Formula hessian = fold.formula(entries_of(form->hessian));
  std::vector<double> numbers(hessian.outputs());
  hessian.evaluate(x.data(), t, numbers.data());
  const auto here = BlockMatrix(form->hessian, numbers).regularity();
  // Velocities found from momenta may be slightly off the place where the determinant vanishes.
  double nearby = -std::numeric_limits<double>::infinity();
  for (const double aside : {-1e-6, 1e-6}) {
    if (form->kind != FormKind::lagrangian) break;
    std::vector<double> y = x, there(numbers.size());
    const auto momentum = static_cast<std::size_t>(form->numbers.momentum);
    for (std::size_t i = momentum; i < momentum + n; ++i) y[i] += aside * (1 + std::abs(y[i]));
    hessian.evaluate(y.data(), t, there.data());
    const double beside = BlockMatrix(form->hessian, there).regularity().log_determinant;
    if (std::isfinite(beside)) nearby = std::max(nearby, beside);
  }
  constexpr double rounding = 1e-14, vanishing = 1e-10;
  if (!(here.reciprocal_condition > rounding && here.log_determinant > nearby + std::log(vanishing)))
    return "is not regular at the start: " + second_derivative() + " has no inverse there";
  if (form->kind == FormKind::metric && !is_positive_definite(form->hessian, numbers))
    return "has a mass that is not positive at the start: " + second_derivative() + " is not positive definite there";
  return {};
} catch (const tape::TooManyOperations&) {
  return "couples too many coordinates: looking at " + second_derivative() + " takes too many operations";
}

}  // namespace least::text
