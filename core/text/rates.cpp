// The equations of motion of a scene given as text, written as text.
#include <algorithm>
#include <array>

#include "core/number/linear.hpp"
#include "core/tape/derivative.hpp"
#include "core/text/collected.hpp"
#include "core/text/scene.hpp"
#include "core/text/sized_scene.hpp"

namespace least::text {
namespace {

/// says_inverse tells whether the inverse of a full constant metric is given, or short enough to be written.
bool says_inverse(const Form& form) {
  if (form.momenta.empty() || form.coordinates <= 2) return true;
  for (std::size_t i = 0; i < form.hessian.size(); ++i)
    for (const auto& entry : form.hessian.row(i))
      if (!entry.value.is_constant()) return false;
  return true;
}
/// in_velocities tells whether the equations are written with velocities: with momenta they would need an inverse, or
/// an iteration.
bool in_velocities(const Form& form) {
  return form.kind == FormKind::metric || form.kind == FormKind::lagrangian || (form.full_mass && !says_inverse(form));
}
/// solved_for_accelerations tells whether the inverse of a metric that depends on q is short enough to be written.
bool solved_for_accelerations(const Form& form) { return form.kind == FormKind::metric && form.coordinates <= 2; }

/// Rates are ẋ and ṗ of a form on a tape; ṡ where the motion reads s.
struct Rates {
  tape::Tape tape;
  std::vector<std::pair<std::string, Symbol>> all;
};

/// forces_of returns what forces add to ṗ; v and p replace the velocities or momenta that the texts read.
std::vector<Symbol> forces_of(const Form& form, Rates& rates, const std::vector<Symbol>& v,
                              const std::vector<Symbol>& p) {
  const std::size_t n = form.coordinates;
  std::vector<Symbol> all(n, Symbol(0));
  if (!form.forced) return all;
  const auto in_place = [&](const std::vector<Symbol>& moving) {
    return tape::Substitution(form.tape, rates.tape, [&form, &rates, &moving](int i) {
      const auto k = static_cast<std::size_t>(i), first = static_cast<std::size_t>(form.numbers.momentum);
      return k >= first && k < first + moving.size() ? moving[k - first] : Symbol::variable(rates.tape, k);
    });
  };
  auto in_velocities = in_place(v), as_typed = in_place(form.momenta.empty() ? p : v);
  for (std::size_t i = 0; i < n; ++i) all[i] = as_typed(form.forces[i]) + in_velocities(form.friction[i]);
  return all;
}

/// write_accelerations writes v̇ = g⁻¹(−∇V + F − Γ v v), Γ_i,jk = ½(∂_j g_ik + ∂_k g_ij − ∂_i g_jk), for one or two
/// coordinates.
void write_accelerations(const Definition& given, const Form& form, Rates& rates, tape::Substitution& copy) {
  auto& tape = rates.tape;
  const std::size_t n = form.coordinates;
  std::vector<int> places;
  std::vector<Symbol> v, g, force;
  for (std::size_t i = 0; i < n; ++i) {
    places.push_back(static_cast<int>(i));
    v.push_back(Symbol::variable(tape, form.numbers.momentum + i));
  }
  for (const Symbol& entry : form.metric.written_out()) g.push_back(copy(entry));
  std::vector<std::vector<Symbol>> slope;  // ∂_k g_ij
  slope.reserve(g.size());
  for (const Symbol& entry : g) slope.push_back(tape::gradient(tape, entry, places));
  const auto potential = tape::gradient(tape, copy(form.potential), places);
  const auto by = [&](std::size_t k, std::size_t i, std::size_t j) { return slope[i * n + j][k]; };
  std::vector<Symbol> p(n, Symbol(0));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) p[i] = p[i] + g[i * n + j] * v[j];
  const auto beside = forces_of(form, rates, v, p);
  for (std::size_t i = 0; i < n; ++i) {
    Symbol sum = beside[i] - potential[i];
    for (std::size_t j = 0; j < n; ++j) {
      sum = sum + (i == j ? Symbol(-0.5) * by(i, i, i) : Symbol(0.5) * by(i, j, j) - by(j, i, j)) * (v[j] * v[j]);
      for (std::size_t k = j + 1; k < n; ++k)  // of two coordinates, j or k is i
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

/// full_velocities returns g⁻¹p for a constant non-diagonal g of a Lagrangian, whose inverse is short enough.
std::vector<Symbol> full_velocities(const Form& form, Rates& rates, tape::Substitution& copy) {
  const std::size_t n = form.coordinates;
  std::vector<Symbol> p;
  p.reserve(n);
  for (std::size_t i = 0; i < n; ++i) p.push_back(Symbol::variable(rates.tape, form.numbers.momentum + i));
  if (n == 2) {
    std::vector<Symbol> g;
    for (const Symbol& entry : form.hessian.written_out()) g.push_back(copy(entry));
    const Symbol determinant = g[0] * g[3] - g[1] * g[2];
    return {(g[3] * p[0] - g[1] * p[1]) / determinant, (g[0] * p[1] - g[2] * p[0]) / determinant};
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& entry : form.hessian.row(i)) numbers.push_back(entry.value.constant());
  BlockMatrix inverse(form.hessian, numbers);
  inverse.invert();
  std::vector<Symbol> v(n, Symbol(0));
  for (const BlockMatrix::Block& block : inverse.blocks())
    for (std::size_t i = 0; i < block.of.size(); ++i)
      for (std::size_t j = 0; j < block.of.size(); ++j)
        v[block.of[i]] = v[block.of[i]] + Symbol(block.numbers[i * block.of.size() + j]) * p[block.of[j]];
  return v;
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
    momenta.push_back(form.numbers.momentum + static_cast<int>(i));
  }
  const Symbol s = same(form.numbers.action);
  Symbol of_action = 0;  // terms with s of H of a natural form
  if (form.kind == FormKind::contact_linear) of_action = copy(form.damping) * s;
  if (form.kind == FormKind::contact_quadratic)
    of_action = Symbol(0.5) * copy(form.action_curvature) * (s * s) - copy(form.offset);
  Symbol h = 0;
  std::vector<Symbol> v;
  const bool lagrangian_mass = form.full_mass && !form.momenta.empty();
  if (form.kind == FormKind::hamiltonian || (form.full_mass && !lagrangian_mass)) {
    h = copy(form.hamiltonian);
  } else if (solved_for_accelerations(form)) {
    return write_accelerations(given, form, rates, copy);
  } else if (in_velocities(form)) {
    const auto velocity = [&](std::size_t i) { return same(momenta[i]); };
    const bool natural = form.kind != FormKind::lagrangian;
    const SymbolMatrix& g = form.full_mass ? form.hessian : form.metric;
    Symbol lagrangian = natural ? -copy(form.potential) - of_action : copy(form.lagrangian);
    for (std::size_t i = 0; i < n && natural; ++i)
      for (const auto& [j, entry] : g.row(i))
        lagrangian = lagrangian + Symbol(0.5) * (velocity(i) * copy(entry) * velocity(j));
    const Symbol by_s = tape::gradient(tape, lagrangian, std::array{form.numbers.action})[0];
    const auto p = tape::gradient(tape, lagrangian, momenta), force = tape::gradient(tape, lagrangian, places);
    for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(momentum_name(names[i]), p[i]);
    for (std::size_t i = 0; i < n; ++i) v.push_back(velocity(i));
    const auto beside = forces_of(form, rates, v, p);
    for (std::size_t i = 0; i < n; ++i)
      rates.all.emplace_back(std::string("d").append(momentum_name(names[i])).append("/dt"),
                             force[i] + p[i] * by_s + beside[i]);
    return;
  } else {
    h = copy(form.potential);
    if (lagrangian_mass) v = full_velocities(form, rates, copy);
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = same(momenta[i]);
      h = h + (lagrangian_mass ? Symbol(0.5) * (p * v[i]) : p * p / (Symbol(2) * copy(form.mass[i])));
    }
    h = h + of_action;
  }
  if (v.empty()) v = tape::gradient(tape, h, momenta);
  const auto force = tape::gradient(tape, h, places);
  const Symbol by_action = tape::gradient(tape, h, std::array{form.numbers.action})[0];
  for (std::size_t i = 0; i < n; ++i) rates.all.emplace_back(names[i], v[i]);
  std::vector<Symbol> p;
  p.reserve(n);
  for (const int i : momenta) p.push_back(same(i));
  const auto beside = forces_of(form, rates, v, p);
  for (std::size_t i = 0; i < n; ++i)
    rates.all.emplace_back(momentum_name(names[i]), beside[i] - force[i] - by_action * p[i]);
  if (by_action.is_constant() && by_action.constant() == 0) return;
  Symbol work = 0;
  for (std::size_t i = 0; i < n; ++i) work = work + same(momenta[i]) * v[i];
  rates.all.emplace_back("s", work - h);
}

}  // namespace

std::string TextScene::note_on_equations(const Said& equations) const {
  if (tape::operations_written_out(form->tape) > static_cast<std::size_t>(tape::most_written_out))
    return "its sums are too long to be written out term by term";
  if (std::ranges::all_of(equations, [](const auto& said) { return said.second == "…"; }))
    return "they take too many operations to be written out";
  if (!in_velocities(*form) || solved_for_accelerations(*form)) return {};
  return "momenta, ∂L/∂v, and their rates, said with velocities: accelerations would need an inverse that is long to "
         "say, and are solved for at every step";
}

TextScene::Said TextScene::equations_in_short() const {
  Said texts;
  for (const auto& name : definition.variables) texts.emplace_back(name, "…");
  if (form->kind != FormKind::flow)
    for (const auto& name : definition.variables) texts.emplace_back(momentum_name(name), "…");
  if (form->reads_action || form->kind == FormKind::contact_linear) texts.emplace_back("s", "…");
  return texts;
}

TextScene::Said TextScene::equations() const try {
  const std::shared_ptr<const Form> plain = with_sums_written_out(form);
  if (!plain) return equations_in_short();
  Rates rates;
  // The limit of a scene's equations does not include the energy from which they are derived here, on the same tape.
  rates.tape.bound(2 * SizedScene::most_equations);
  write_rates(definition, *plain, rates);
  const bool velocities = in_velocities(*form);  // computed once: it looks at all masses
  const auto name = [&](int i) -> std::string {
    const Numbering& numbers = form->numbers;
    if (i >= numbers.parameter) return definition.parameters[static_cast<std::size_t>(i - numbers.parameter)].first;
    if (form->kind == FormKind::flow || i < numbers.momentum) return definition.variables[static_cast<std::size_t>(i)];
    if (i == numbers.action) return "s";
    const auto& coordinate = definition.variables[static_cast<std::size_t>(i - numbers.momentum)];
    return velocities ? velocity_name(coordinate) : momentum_name(coordinate);
  };
  Said texts;
  // Operations of rates that may still be searched; a rate that exceeds them is shown as …
  std::size_t left = most_looked_at;
  for (const auto& [of, rate] : rates.all) {
    const std::size_t parts = rate.is_constant() ? 0 : left == 0 ? 1 : tape::parts_of(rates.tape, rate.place()).size();
    texts.emplace_back(of, parts > left ? "…" : print_collected(rates.tape, rate, name));
    left -= std::min(parts, left);
  }
  return texts;
} catch (const tape::TooManyOperations&) {  // such as the full inverse of a matrix of many masses
  return equations_in_short();
}

}  // namespace least::text
