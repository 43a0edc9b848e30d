#include "core/text/sized_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/memory_budget.hpp"
#include "core/tape/derivative.hpp"
#include "core/text/lift.hpp"

namespace least::text {
namespace {

/// without_numbers returns a sum without its constant terms, and the total of these.
std::pair<Symbol, double> without_numbers(tape::Tape& tape, const Symbol& sum) {
  struct Term {
    Symbol value;
    bool negative;
  };
  std::vector<Term> open{{sum, false}}, terms;
  double numbers = 0;
  while (!open.empty()) {
    const auto [value, negative] = open.back();
    open.pop_back();
    const tape::Node node = value.is_constant() ? tape::Node{} : tape[value.place()];
    if (value.is_constant() || node.op == tape::Op::constant) {
      numbers += (negative ? -1 : 1) * (value.is_constant() ? value.constant() : node.value);
    } else if (node.op == tape::Op::add || node.op == tape::Op::subtract) {
      open.push_back({Symbol::at(tape, node.b), negative != (node.op == tape::Op::subtract)});
      open.push_back({Symbol::at(tape, node.a), negative});
    } else {
      terms.push_back({value, negative});
    }
  }
  if (numbers == 0) return {sum, 0};
  Symbol rest = 0;
  for (const auto& [value, negative] : terms) rest = negative ? rest - value : rest + value;
  return {rest, numbers};
}

}  // namespace

namespace {

/// is_damped_metric tells whether a general H has an s that the motion of q and p does not need: form.hpp keeps the
/// Lagrangian to which s adds α(t) s.
bool is_damped_metric(const Form& form) {
  return form.kind == FormKind::hamiltonian && !(form.lagrangian.is_constant() && form.lagrangian.constant() == 0);
}

}  // namespace

bool SizedScene::has(const Form& form) { return form.kind != FormKind::lagrangian || Velocities::fits(form.hessian); }

SizedScene::SizedScene(const Form& form, std::span<const double> parameters)
    : kind(form.kind),
      coordinates(form.coordinates),
      flow(form.kind == FormKind::flow),
      forced(form.forced),
      acting(form.kind == FormKind::contact_linear || form.reads_action),
      reads_action(form.reads_action || form.kind == FormKind::contact_linear),
      constant_damping(form.constant_damping),
      autonomous(form.autonomous),
      keeps_energy(form.keeps_energy) {
  const std::size_t n = coordinates;
  components = flow ? n : 2 * n + (acting ? 1 : 0);
  moving = kind == FormKind::contact_linear || is_damped_metric(form) ? 2 * n : components;
  equations.bound(most_equations);
  // For the tape alone; formulas are charged once their length is known.
  constexpr std::size_t bytes_of_typed = 96;
  held_.add_soon(bytes_of_typed * static_cast<std::size_t>(form.tape.size()));
  const auto variable = [&](std::size_t i) { return Symbol::variable(equations, i); };
  const Numbering& numbers = form.numbers;
  tape::Substitution fold(form.tape, equations, [&](int i) {
    if (i >= numbers.parameter) return Symbol(parameters[static_cast<std::size_t>(i - numbers.parameter)]);
    if (flow || i < numbers.momentum) return variable(static_cast<std::size_t>(i));
    return i == numbers.action ? variable(2 * n) : variable(n + static_cast<std::size_t>(i - numbers.momentum));
  });
  const auto folded = [&](const std::vector<Symbol>& all) {
    std::vector<Symbol> made;
    made.reserve(all.size());
    for (const Symbol& y : all) made.push_back(fold(y));
    return made;
  };
  const auto formula = [&](const std::vector<Symbol>& some) { return formula_of(some); };
  const auto of_state = [&](const std::vector<Symbol>& some) {
    return StateFormula(formula_of(some), components, velocities);
  };
  const auto number = [](const Symbol& y) {
    return y.is_constant() ? y.constant() : std::numeric_limits<double>::quiet_NaN();
  };

  std::vector<Symbol> all(components);
  std::vector<int> places(n);
  std::iota(places.begin(), places.end(), 0);
  if (flow) {
    all = folded(form.rates);
  } else if (kind == FormKind::lagrangian) {
    all = set_lagrangian(form, fold);
  } else if (kind == FormKind::metric) {
    all = set_metric(form, fold);
  } else if (kind == FormKind::hamiltonian) {
    const Symbol h = fold(form.hamiltonian);
    for (std::size_t i = n; i <= 2 * n; ++i) places.push_back(static_cast<int>(i));
    const std::vector<Symbol> slopes = tape::gradient(equations, h, places);
    Symbol work = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = variable(n + i);
      all[i] = slopes[n + i];
      all[n + i] = acting ? -slopes[i] - p * slopes[2 * n] : -slopes[i];
      if (acting) work = i == 0 ? p * all[i] : work + p * all[i];
    }
    if (acting) all[2 * n] = work - h;
    hamiltonian = of_state({h, slopes[2 * n]});
    lift = Lift::of(form, parameters);
    if (moving < components && n <= most_full) lagrangian = formula(with_slopes(fold(form.lagrangian)));
  } else {
    const Symbol v = fold(form.potential), alpha = fold(form.damping), s = variable(2 * n);
    action_curvature = number(fold(form.action_curvature));
    offset = number(fold(form.offset));
    const Symbol by_s = is_quadratic() ? Symbol(action_curvature) * s : alpha;
    const Symbol of_s = is_quadratic() ? Symbol(0.5 * action_curvature) * (s * s) - Symbol(offset) : alpha * s;
    const std::vector<Symbol> slopes = tape::gradient(equations, v, places);
    std::vector<double> second;
    for (std::size_t i = 0; i < n && form.full_mass; ++i)
      for (const auto& entry : form.hessian.row(i)) second.push_back(number(fold(entry.value)));
    set_mass(folded(form.mass), form.hessian, second, !form.momenta.empty());
    Symbol twice_kinetic = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol p = variable(n + i);
      Symbol velocity = has_full_mass() ? Symbol(0) : Symbol(inverse_mass_[i]) * p;
      if (has_full_mass())
        for (const auto& [j, share] : inverse_matrix_[i]) velocity = velocity + Symbol(share) * variable(n + j);
      all[i] = velocity;
      all[n + i] = acting ? -slopes[i] - by_s * p : -slopes[i];
      if (acting) twice_kinetic = i == 0 ? p * velocity : twice_kinetic + p * velocity;
    }
    if (acting) all[2 * n] = Symbol(0.5) * twice_kinetic - v - of_s;
    if (is_quadratic()) hamiltonian = of_state({Symbol(0.5) * twice_kinetic + v + of_s, by_s});
    if (is_quadratic() && n <= most_full) lagrangian = formula(slopes_of_lagrangian(v, of_s));
    potential = formula({v});
    if (kind == FormKind::separable && !forced) {
      const auto [varying, constant] = without_numbers(equations, v);
      constant_potential = constant;
      if (constant != 0) varying_potential = formula({varying});
    }
    gradient = formula(slopes);
    if (n <= tape::SparseJacobian::few) {
      std::vector<Symbol> both{v};
      both.insert(both.end(), slopes.begin(), slopes.end());
      potential_and_gradient = formula(both);
    }
    for (const Symbol& slope : slopes) slopes_.push_back(slope.on(equations));
    damping = formula({alpha});
    if (constant_damping) constant_alpha_ = number(alpha);
  }
  if (forced) {
    const std::vector<Symbol> v(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n));
    tape::Substitution with_velocities(form.tape, equations, [&](int i) {
      if (i >= numbers.parameter) return Symbol(parameters[static_cast<std::size_t>(i - numbers.parameter)]);
      const auto k = static_cast<std::size_t>(i);
      return i < numbers.momentum ? variable(k) : v[k - static_cast<std::size_t>(numbers.momentum)];
    });
    std::vector<Symbol> force(n);
    Symbol power = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Symbol typed = form.momenta.empty() ? fold(form.forces[i]) : with_velocities(form.forces[i]);
      force[i] = typed + with_velocities(form.friction[i]);
      all[n + i] = all[n + i] + force[i];
      power = power + force[i] * v[i];
    }
    all.push_back(power);
    components = moving + 1;
    set_forces(force);
  }
  for (const Symbol& y : all) rates.push_back(y.on(equations));
  all.resize(components);
  if (rate.outputs() == 0) rate = of_state(all);
  if (components > moving) motion_ = {tape::Formula(equations, std::span(rates).first(moving)), components, nullptr};
  all = folded(form.invariants);
  all.resize(most_invariants);
  invariants = formula(all);
  shared_.clear();
  held_.shrink_to(bytes());
}

tape::Formula SizedScene::formula_of(const std::vector<Symbol>& all) {
  constexpr std::size_t bytes_of_made = 128;
  std::vector<tape::Index> places;
  places.reserve(all.size());
  for (const Symbol& y : all) places.push_back(y.on(equations));
  const std::size_t made = bytes() + bytes_of_made * static_cast<std::size_t>(equations.size());
  if (made > held_.bytes()) held_.add_soon(made - held_.bytes());
  return {equations, places, &shared_};
}

std::size_t SizedScene::bytes() const {
  constexpr std::size_t of_tape = 48, of_formula = 40, copies_of_terms = 2;
  std::size_t steps = 0;
  for (const tape::Formula* made : {&potential, &varying_potential, &gradient, &damping, &potential_and_gradient,
                                    &lagrangian, &lowered, &invariants, &forces.values, &forces.jacobian})
    steps += made->operations();
  for (const StateFormula* made : {&rate, &motion_, &hamiltonian, &raised}) steps += made->operations();
  if (equations.has_terms()) return (1 + copies_of_terms) * equations.bytes();
  return of_tape * static_cast<std::size_t>(equations.size()) + of_formula * steps;
}

void SizedScene::set_forces(const std::vector<Symbol>& all) {
  const std::size_t n = coordinates;
  const auto formula = [&](const std::vector<Symbol>& some) {
    std::vector<tape::Index> places;
    places.reserve(some.size());
    for (const Symbol& y : some) places.push_back(y.on(equations));
    return tape::Formula(equations, places);
  };
  forces.values = formula(all);
  if (kind != FormKind::separable) return;
  const auto is_zero = [](const Symbol& y) { return y.is_constant() && y.constant() == 0; };
  constexpr tape::Dependence by_places = 1, by_momenta = 2;
  tape::Dependences depends(equations, [n](int i) { return static_cast<std::size_t>(i) < n ? by_places : by_momenta; });
  tape::Substitution at_rest(equations, equations, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return k < n ? Symbol::variable(equations, k) : Symbol(0);
  });
  // A force may jump where the two branches of a select differ at rest; those of |v| do not.
  const auto jumps_at_rest = [&](const tape::Node& node) {
    const Symbol below = at_rest(Symbol::at(equations, node.b)), above = at_rest(Symbol::at(equations, node.c));
    if (below.is_constant() && above.is_constant()) return below.constant() != above.constant();
    return below.is_constant() || above.is_constant() || below.place() != above.place();
  };
  // Every select that reads momenta is a part of a force. Dry friction, −sign(v), has slopes 0 although it is not
  // linear.
  std::vector<tape::Index> jumps;
  for (tape::Index i = 0, written = equations.size(); i < written; ++i) {
    const tape::Node node = equations[i];
    if (node.op != tape::Op::select || (depends(Symbol::at(equations, node.a)) & by_momenta) == 0) continue;
    forces.linear = false;
    if (jumps_at_rest(node)) jumps.push_back(i);
  }
  if (!jumps.empty()) set_jumps(all, jumps);
  std::vector<Symbol> full = all, diagonal = all;
  bool rests = true;  // forces vanish at rest
  std::size_t left = most_looked_at;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::pair<std::size_t, Symbol>> row;
    try {
      row = tape::slopes_of(equations, all[i], static_cast<int>(n), n, left);
    } catch (const tape::TooManyOperations&) {  // too many coordinates are coupled for implicit equations
      forces.linear = forces.diagonal = forces.constant = false;
      return;
    }
    if (n <= most_coupled) full.resize(full.size() + n, Symbol(0));
    diagonal.emplace_back(0);
    for (const auto& [j, slope] : row) {
      const tape::Dependence of = depends(slope);
      forces.diagonal = forces.diagonal && i == j;
      forces.linear = forces.linear && (of & by_momenta) == 0;
      forces.constant = forces.constant && of == 0;
      if (i == j) diagonal.back() = slope;
      if (n <= most_coupled) full[full.size() - n + j] = slope;
    }
    rests = rests && is_zero(at_rest(all[i]));
  }
  if (forces.diagonal || n <= most_coupled) forces.jacobian = formula(forces.diagonal ? diagonal : full);
  const auto same = [&](const Symbol& slope) {
    return slope.is_constant() && slope.constant() == diagonal[n].constant();
  };
  if (rests && forces.diagonal && std::all_of(diagonal.begin() + static_cast<std::ptrdiff_t>(n), diagonal.end(), same))
    forces.friction = std::max(0.0, -diagonal[n].constant());
}

void SizedScene::set_jumps(const std::vector<Symbol>& all, const std::vector<tape::Index>& jumps) {
  const std::size_t n = coordinates;
  forces.jumps = true;
  forces.jumping.assign(n, false);
  std::size_t left = most_looked_at;
  const auto parts_of = [&](tape::Index place) {
    std::vector<tape::Index> parts = tape::parts_of(equations, place);
    // forces that are too long to search might read any momentum
    forces.jumps_alone = forces.jumps_alone && parts.size() <= left;
    left -= std::min(left, parts.size());
    return parts;
  };
  for (std::size_t i = 0; i < n && forces.jumps_alone; ++i) {
    if (all[i].is_constant()) continue;
    for (const tape::Index part : parts_of(all[i].place())) {
      if (!std::ranges::binary_search(jumps, part)) continue;
      forces.jumping[i] = true;
      for (const tape::Index read : parts_of(equations[part].a)) {
        const tape::Node& node = equations[read];
        const auto variable = static_cast<std::size_t>(node.op == tape::Op::variable ? node.value : 0);
        if (variable >= n && variable != n + i) forces.jumps_alone = false;
      }
    }
  }
}

void SizedScene::set_mass(const std::vector<Symbol>& mass, const SymbolMatrix& hessian,
                          const std::vector<double>& second, bool of_velocities) {
  const std::size_t n = coordinates;
  inverse_mass_.assign(n, 1);
  for (std::size_t i = 0; i < mass.size(); ++i)
    inverse_mass_[i] = mass[i].is_constant() ? 1 / mass[i].constant() : std::numeric_limits<double>::quiet_NaN();
  if (second.empty()) return;
  // Symmetrized exactly: drifts are symplectic only where the matrix is exactly symmetric.
  inverse_matrix_.resize(n);
  if (of_velocities) {
    BlockMatrix inverse(hessian, second);
    inverse.invert();
    for (const BlockMatrix::Block& block : inverse.blocks()) {
      const std::size_t size = block.of.size();
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size; ++j) {
          const double share = 0.5 * (block.numbers[i * size + j] + block.numbers[j * size + i]);
          if (share != 0) inverse_matrix_[block.of[i]].emplace_back(block.of[j], share);
        }
    }
    return;
  }
  std::size_t next = 0;
  std::vector<std::map<std::size_t, double>> rows(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& entry : hessian.row(i)) {
      const double half = 0.5 * second[next++];
      rows[i][entry.column] += half;
      rows[entry.column][i] += half;
    }
  for (std::size_t i = 0; i < n; ++i) inverse_matrix_[i].assign(rows[i].begin(), rows[i].end());
}

const tape::SparseJacobian& SizedScene::curvature() const {
  std::call_once(curvature_->made, [&] {
    const HeldByThread same(budget_);
    // For each operation a bit per coordinate that it reads; then the entries.
    Held held = HeldByThread::take_soon(static_cast<std::size_t>(equations.size()) * (coordinates / 8 + 1));
    auto made = std::make_unique<const tape::SparseJacobian>(equations, slopes_, coordinates,
                                                             tape::SparseJacobian::Kind::hessian);
    held.shrink_to(0);
    held.add_soon(made->bytes());
    curvature_->of = std::move(made);
    curvature_->held = std::move(held);
  });
  return *curvature_->of;
}

std::optional<SizedScene::Plain> SizedScene::plain() const {
  if (!equations.has_terms()) return Plain{equations, rates};
  constexpr std::size_t bytes_of_operation = 192;
  std::call_once(written_out_->made, [&] {
    const HeldByThread same(budget_);
    try {
      const auto most = static_cast<std::size_t>(tape::most_written_out);
      Held held = HeldByThread::take_soon(bytes_of_operation * std::min(most, tape::operations_written_out(equations)));
      written_out_->of.emplace(tape::written_out(equations, rates, tape::most_written_out));
      held.shrink_to(written_out_->of->tape.bytes());
      written_out_->held = std::move(held);
    } catch (const tape::TooManyOperations&) {
    }
  });
  if (!written_out_->of) return std::nullopt;
  return Plain{written_out_->of->tape, written_out_->of->roots};
}

const tape::Program& SizedScene::series(bool all) const {
  constexpr std::size_t bytes_of_operation = 104, meanwhile = 320;
  const std::size_t count = all ? components : moving;
  SeriesProgram& known = *(count == components ? series_ : motion_series_);
  std::call_once(known.made, [&] {
    const HeldByThread same(budget_);
    const std::optional<Plain> from = plain();
    if (!from) throw tape::TooManyOperations();
    const auto size = static_cast<std::size_t>(from->tape.size());
    Held held = HeldByThread::take_soon(meanwhile * size);
    // Components that the motion does not read have no influence on step sizes.
    known.of.emplace(from->tape, from->rates.first(count + found()), found() > 0 ? count + found() : moving);
    held.shrink_to(bytes_of_operation * size);
    known.held = std::move(held);
  });
  return *known.of;
}

std::shared_ptr<const SizedScene> SizedScenes::with(const Form& form, std::span<const double> parameters) {
  {
    const std::lock_guard lock(mutex_);
    const auto same = [](double a, double b) { return a == b && std::signbit(a) == std::signbit(b); };
    if (last_ && std::ranges::equal(parameters_, parameters, same)) return last_;
  }
  auto made = std::make_shared<const SizedScene>(form, parameters);
  const std::lock_guard lock(mutex_);
  parameters_.assign(parameters.begin(), parameters.end());
  return last_ = std::move(made);
}

}  // namespace least::text
