#include "core/text/scene.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"
#include "core/text/folding.hpp"
#include "core/text/print.hpp"
#include "core/text/scenes.hpp"

namespace least::text {
namespace {

constexpr double default_span = 20;

std::string number_text(double x) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.begin(), digits.end(), x).ptr};
}

std::string shown(std::string_view name) { return "<mi>" + std::string(name) + "</mi>"; }

std::string mathml_of(const std::string& text) {
  const auto parsed = Expression::parse(text);
  return std::get<Expression>(parsed).mathml(shown);
}

std::string formula_of(const Definition& given) {
  using Kind = Definition::Kind;
  std::string inside;
  if (given.kind == Kind::equations) {
    for (const auto& [name, text] : given.equations)
      inside += "<mtr><mtd><mover>" + shown(name) + "<mo>˙</mo></mover></mtd><mtd><mo>=</mo></mtd><mtd>" +
                mathml_of(text) + "</mtd></mtr>";
    return "<math><mtable>" + inside + "</mtable></math>";
  }
  const char* letter = given.kind == Kind::lagrangian ? "L" : given.kind == Kind::hamiltonian ? "H" : "V";
  inside = shown(letter) + "<mo>=</mo>" + mathml_of(given.formula);
  const auto more = [&](const char* name, const std::optional<std::string>& text) {
    if (text) inside += "<mo>,</mo><mspace width=\"1em\"/>" + shown(name) + "<mo>=</mo>" + mathml_of(*text);
  };
  more("α", given.damping);
  more("γ", given.action_curvature);
  more("R", given.offset);
  return "<math>" + inside + "</math>";
}

/// Its equations are said with velocities: with momenta they would need an inverse, or an iteration.
bool in_velocities(const Form& form) { return form.kind == FormKind::metric || form.kind == FormKind::lagrangian; }
/// The inverse of its metric is short enough to be said.
bool solved_for_accelerations(const Form& form) { return form.kind == FormKind::metric && form.coordinates <= 2; }

/// On the tape, ẋ and ṗ of a form; ṡ where the motion reads s.
struct Rates {
  tape::Tape tape;
  std::vector<std::pair<std::string, Symbol>> all;
};

/// v̇ = g⁻¹(−∇V − Γ v v), Γ_i,jk = ½(∂_j g_ik + ∂_k g_ij − ∂_i g_jk), of one coordinate or two.
void write_accelerations(const Definition& given, const Form& form, Rates& rates, tape::Substitution& copy) {
  auto& tape = rates.tape;
  const std::size_t n = form.coordinates;
  std::vector<int> places;
  std::vector<Symbol> v, g, force;
  for (std::size_t i = 0; i < n; ++i) {
    places.push_back(static_cast<int>(i));
    v.push_back(Symbol::variable(tape, first_momentum + i));
  }
  for (const Symbol& entry : form.metric) g.push_back(copy(entry));
  std::vector<std::vector<Symbol>> slope;  // ∂_k g_ij
  slope.reserve(g.size());
  for (const Symbol& entry : g) slope.push_back(tape::gradient(tape, entry, places));
  const auto potential = tape::gradient(tape, copy(form.potential), places);
  const auto by = [&](std::size_t k, std::size_t i, std::size_t j) { return slope[i * n + j][k]; };
  for (std::size_t i = 0; i < n; ++i) {
    Symbol sum = -potential[i];
    for (std::size_t j = 0; j < n; ++j) {
      sum = sum + (i == j ? Symbol(-0.5) * by(i, i, i) : Symbol(0.5) * by(i, j, j) - by(j, i, j)) * (v[j] * v[j]);
      for (std::size_t k = j + 1; k < n; ++k)  // of two, one is i
        sum = sum - by(i == j ? k : j, i, i) * (v[j] * v[k]);
    }
    force.push_back(sum);
  }
  for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(given.variables[i], v[i]);
  const auto add = [&](std::size_t i, const Symbol& rate) {
    rates.all.emplace_back(velocity_name(given.variables[i]), rate);
  };
  if (n == 1 || (g[1].is_constant() && g[1].constant() == 0)) {
    for (std::size_t i = 0; i < n; ++i) add(i, force[i] / g[i * n + i]);
    return;
  }
  const Symbol determinant = g[0] * g[3] - g[1] * g[2];
  add(0, (g[3] * force[0] - g[1] * force[1]) / determinant);
  add(1, (g[0] * force[1] - g[2] * force[0]) / determinant);
}

void write_rates(const Definition& given, const Form& form, Rates& rates) {
  auto& tape = rates.tape;
  const auto same = [&](int i) { return Symbol::variable(tape, static_cast<std::size_t>(i)); };
  tape::Substitution copy(form.tape, tape, same);
  const auto n = form.coordinates;
  const auto& names = given.variables;
  if (form.kind == FormKind::flow) {
    for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(names[i], copy(form.rates[i]));
    return;
  }
  std::vector<int> places, momenta;
  for (std::size_t i = 0; i < n; ++i) {
    places.push_back(static_cast<int>(i));
    momenta.push_back(first_momentum + static_cast<int>(i));
  }
  const Symbol s = same(action_variable);
  Symbol h = 0;
  if (form.kind == FormKind::hamiltonian) {
    h = copy(form.hamiltonian);
  } else if (solved_for_accelerations(form)) {
    return write_accelerations(given, form, rates, copy);
  } else if (in_velocities(form)) {
    const auto velocity = [&](std::size_t i) { return same(momenta[i]); };
    Symbol lagrangian = form.kind == FormKind::metric ? -copy(form.potential) : copy(form.lagrangian);
    for (std::size_t i = 0; i < n && form.kind == FormKind::metric; ++i)
      for (std::size_t j = 0; j < n; ++j)
        lagrangian = lagrangian + Symbol(0.5) * (velocity(i) * copy(form.metric[i * n + j]) * velocity(j));
    const Symbol by_s = tape::gradient(tape, lagrangian, std::array{action_variable})[0];
    const auto p = tape::gradient(tape, lagrangian, momenta), force = tape::gradient(tape, lagrangian, places);
    for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(momentum_name(names[i]), p[i]);
    for (std::size_t i = 0; i < n; ++i)
      rates.all.emplace_back(std::string("d").append(momentum_name(names[i])).append("/dt"), force[i] + p[i] * by_s);
    return;
  } else {
    h = copy(form.potential);
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = same(momenta[i]);
      h = h + p * p / (Symbol(2) * copy(form.mass[i]));
    }
    if (form.kind == FormKind::contact_linear) h = h + copy(form.damping) * s;
    if (form.kind == FormKind::contact_quadratic)
      h = h + Symbol(0.5) * copy(form.action_curvature) * (s * s) - copy(form.offset);
  }
  const auto v = tape::gradient(tape, h, momenta), force = tape::gradient(tape, h, places);
  const Symbol by_action = tape::gradient(tape, h, std::array{action_variable})[0];
  for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(names[i], v[i]);
  for (std::size_t i = 0; i < n; ++i)
    rates.all.emplace_back(momentum_name(names[i]), -force[i] - by_action * same(momenta[i]));
  if (by_action.is_constant() && by_action.constant() == 0) return;
  Symbol work = 0;
  for (std::size_t i = 0; i < n; ++i) work = work + same(momenta[i]) * v[i];
  rates.all.emplace_back("s", work - h);
}

/// Two of the kinds that are compiled for two.
int capacity_of(const Form& form) {
  const int least = form.coordinates <= 2 ? 2 : most_coordinates;
  switch (form.kind) {
    case FormKind::flow:
      return most_variables;
    case FormKind::separable:
    case FormKind::metric:
      return form.autonomous ? least : most_coordinates;
    case FormKind::contact_linear:
      return form.autonomous || !form.constant_damping ? least : most_coordinates;
    default:
      return most_coordinates;
  }
}

}  // namespace

std::variant<TextScene, std::vector<DefinitionFault>> TextScene::read(Definition definition) {
  auto form = form_of(definition);
  if (auto* faults = std::get_if<std::vector<DefinitionFault>>(&form)) return std::move(*faults);
  TextScene scene{std::move(definition), std::get<std::shared_ptr<const Form>>(form)};
  scene.capacity = capacity_of(*scene.form);
  return scene;
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
  const auto hide = [&](const char* what, std::size_t from, int to) {
    for (std::size_t i = from; i < static_cast<std::size_t>(to); ++i) {
      add(std::string("·") + what + std::to_string(i), "of no use here");
      card.variables.back().hidden = true;
    }
  };
  const std::size_t n = form->coordinates;
  for (const auto& name : definition.variables) add(name, flow ? "variable" : "coordinate");
  hide("q", n, capacity);
  if (!flow) {
    for (const auto& name : definition.variables) add(momentum_name(name), "momentum of " + name);
    hide("p", n, capacity);
    const bool acting = form->kind == FormKind::contact_linear || form->kind == FormKind::contact_quadratic ||
                        form->kind == FormKind::hamiltonian || form->kind == FormKind::lagrangian;
    if (acting) {
      const bool rests = !form->reads_action && form->kind != FormKind::contact_linear;
      add(rests ? "·s" : "s", rests ? "of no use here" : "action");
      card.variables.back().hidden = rests;
      card.variables.back().optional = !rests && !form->reads_action;
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
  return card;
}

void TextScene::velocities_to_momenta(std::span<const double> parameters, double t, std::vector<double>& state) const {
  Folding fold(form->tape, parameters);
  const tape::Formula formula = fold.formula(form->momenta);
  std::vector<double> x(static_cast<std::size_t>(action_variable) + 1, 0.0), p(form->coordinates);
  std::copy_n(state.begin(), capacity, x.begin());
  std::copy_n(state.begin() + capacity, capacity, x.begin() + first_momentum);
  if (state.size() > 2 * static_cast<std::size_t>(capacity)) x[action_variable] = state.back();
  formula.evaluate(x.data(), t, p.data());
  std::copy(p.begin(), p.end(), state.begin() + capacity);
}

std::optional<TextScene::Objection> TextScene::objection(std::span<const double> parameters) const {
  Folding fold(form->tape, parameters);
  const bool typed = definition.kind == Definition::Kind::potential;
  const char* whole = definition.kind == Definition::Kind::lagrangian ? "/lagrangian" : "/hamiltonian";
  for (std::size_t i = 0; i < form->mass.size(); ++i) {
    const double mass = fold.number(form->mass[i]);
    const auto& name = definition.variables[i];
    if (mass > 0 && std::isfinite(mass) && std::isfinite(1 / mass)) continue;
    if (typed) return Objection{"/masses/" + name, "is not positive"};
    return Objection{whole, "is not regular: with these parameters the mass of " + name + " is not positive"};
  }
  const auto number = [&](const Symbol& y) {
    const Symbol folded = fold(y);
    return !folded.is_constant() || std::isfinite(folded.constant());
  };
  if (!number(form->damping)) return Objection{typed ? "/damping" : whole, "has a damping that is no finite number"};
  if (!number(form->action_curvature) || !number(form->offset))
    return Objection{typed ? "/action_curvature" : whole, "is no finite number"};
  return std::nullopt;
}

std::optional<TextScene::Objection> TextScene::objection_to_start(std::span<const double> parameters, double t,
                                                                  const std::vector<double>& state) const {
  const Formulas formulas(*form, parameters);
  const bool flow = form->kind == FormKind::flow;
  const std::size_t n = form->coordinates, half = flow ? 0 : static_cast<std::size_t>(capacity);
  std::vector<double> x(static_cast<std::size_t>(first_parameter), 0.0);  // as the tapes count
  std::copy_n(state.begin(), n, x.begin());
  if (!flow) std::copy_n(state.begin() + capacity, n, x.begin() + first_momentum);
  if (!flow && state.size() > 2 * half) x[action_variable] = state.back();
  const char* whole = definition.kind == Definition::Kind::lagrangian    ? "/lagrangian"
                      : definition.kind == Definition::Kind::hamiltonian ? "/hamiltonian"
                                                                         : "/potential";
  if (form->kind == FormKind::lagrangian) {
    Vec<most_coordinates> q{}, p{};
    std::copy_n(x.begin(), n, q.begin());
    std::copy_n(x.begin() + first_momentum, n, p.begin());
    const auto v = formulas.velocities(q, p, x[action_variable], t);
    if (!std::isfinite(v[0])) return Objection{whole, "has no velocity for the momenta of the start"};
    std::copy_n(v.begin(), n, x.begin() + first_momentum);
  }
  if (!form->hessian.empty())
    if (const std::string why = objection_to_masses(parameters, t, x); !why.empty()) return Objection{whole, why};

  const auto finite = [&](const tape::Formula& formula) {
    std::vector<double> values(formula.outputs());
    formula.evaluate(x.data(), t, values.data());
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  const auto unbounded = [&](std::string pointer) {
    std::string detail = "is not finite at the start, or has a derivative that is not: ";
    for (std::size_t i = 0; i < n; ++i) detail += definition.variables[i] + " = " + number_text(x[i]) + ", ";
    return Objection{std::move(pointer), detail + "t = " + number_text(t)};
  };
  if (flow) {
    std::vector<double> rates(n);
    formulas.rates.evaluate(x.data(), t, rates.data());
    for (std::size_t i = 0; i < n; ++i)
      if (!std::isfinite(rates[i])) return unbounded("/equations/" + definition.variables[i]);
    return std::nullopt;
  }
  if (!finite(formulas.damping)) return unbounded(definition.kind == Definition::Kind::potential ? "/damping" : whole);
  for (const auto* part : {&formulas.potential, &formulas.gradient, &formulas.metric, &formulas.hamiltonian,
                           &formulas.slopes, &formulas.lagrangian, &formulas.momenta})
    if (!finite(*part)) return unbounded(whole);
  return std::nullopt;
}

std::string TextScene::objection_to_masses(std::span<const double> parameters, double t,
                                           const std::vector<double>& x) const {
  const std::size_t n = form->coordinates;
  Folding fold(form->tape, parameters);
  const tape::Formula hessian = fold.formula(form->hessian);
  std::vector<double> matrix(n * n);
  hessian.evaluate(x.data(), t, matrix.data());
  double volume = 1;  // of rows as long as these at right angles
  for (std::size_t i = 0; i < n; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < n; ++j) row += matrix[i * n + j] * matrix[i * n + j];
    volume *= std::sqrt(row);
  }
  auto lu = matrix;
  const double determinant = detail::determinant_by_lu(n, lu.data());
  const std::string second = std::string("its second derivative by the ") +
                             (definition.kind == Definition::Kind::lagrangian ? "velocities" : "momenta");
  // Velocities that were found from momenta may miss the place where it vanishes by a little.
  double nearby = 0;
  for (const double aside : {-1e-6, 1e-6}) {
    if (form->kind != FormKind::lagrangian) break;
    std::vector<double> y = x, there(n * n);
    for (std::size_t i = first_momentum; i < first_momentum + n; ++i) y[i] += aside * (1 + std::abs(y[i]));
    hessian.evaluate(y.data(), t, there.data());
    const double here = std::abs(detail::determinant_by_lu(n, there.data()));
    if (std::isfinite(here)) nearby = std::max(nearby, here);
  }
  constexpr double rounding = 1e-14, vanishing = 1e-10;
  if (!(std::isfinite(determinant) && std::abs(determinant) > std::max(rounding * volume, vanishing * nearby)))
    return "is not regular at the start: " + second + " has no inverse there";
  if (form->kind != FormKind::metric) return {};
  // Cholesky's elimination: a metric is positive definite where every pivot is.
  for (std::size_t k = 0; k < n; ++k) {
    if (!(matrix[k * n + k] > 0))
      return "has a mass that is not positive at the start: " + second + " is not positive definite there";
    for (std::size_t i = k + 1; i < n; ++i)
      for (std::size_t j = k + 1; j < n; ++j)
        matrix[i * n + j] -= matrix[i * n + k] * matrix[k * n + j] / matrix[k * n + k];
  }
  return {};
}

std::string TextScene::note_on_equations() const {
  if (!in_velocities(*form) || solved_for_accelerations(*form)) return {};
  return "momenta, ∂L/∂v, and their rates, said with velocities: accelerations would need an inverse that is long to "
         "say, and are solved for at every step";
}

std::vector<std::pair<std::string, std::string>> TextScene::equations() const {
  Rates rates;
  write_rates(definition, *form, rates);
  const auto name = [&](int i) -> std::string {
    if (i >= first_parameter && form->kind != FormKind::flow)
      return definition.parameters[static_cast<std::size_t>(i - first_parameter)].first;
    if (form->kind == FormKind::flow)
      return i < first_parameter ? definition.variables[static_cast<std::size_t>(i)]
                                 : definition.parameters[static_cast<std::size_t>(i - first_parameter)].first;
    if (i == action_variable) return "s";
    if (i < first_momentum) return definition.variables[static_cast<std::size_t>(i)];
    const auto& coordinate = definition.variables[static_cast<std::size_t>(i - first_momentum)];
    return in_velocities(*form) ? velocity_name(coordinate) : momentum_name(coordinate);
  };
  std::vector<std::pair<std::string, std::string>> texts;
  for (const auto& [of, rate] : rates.all) texts.emplace_back(of, print(rates.tape, rate, name));
  return texts;
}

}  // namespace least::text
