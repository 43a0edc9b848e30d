#include "core/text/form.hpp"

#include <algorithm>

#include "core/memory_budget.hpp"
#include "core/tape/derivative.hpp"
#include "core/text/symbol_matrix.hpp"
#include "core/text/text_reader.hpp"

namespace least::text {
namespace {

using tape::Dependence;

/// What a symbol may depend on; parameters do not count, as they are numbers of a scene.
constexpr Dependence on_places = 1, on_momenta = 2, on_action = 4;

/// Reader reads the texts of a definition and finds its form.
class Reader : TextReader {
 public:
  using TextReader::TextReader;

  std::variant<std::shared_ptr<const Form>, std::vector<DefinitionFault>> read() {
    check_names();
    if (!faults().empty()) return faults();
    form_->tape.bound(static_cast<tape::Index>(8 * operations()));
    // Memory for names and tokens, and for intermediate derivatives.
    constexpr std::size_t bytes_of_character = 48;
    Held meanwhile = HeldByThread::take_soon(bytes_of_character * given_.characters());
    try {
      read_invariants();
      given_.kind == Definition::Kind::equations ? read_flow() : read_mechanics();
      if (faults().empty()) read_forces();
    } catch (const tape::TooManyOperations&) {
      fault("", "its derivatives take too many operations", std::to_string(operations()) + " in the texts");
    }
    if (!faults().empty()) return faults();
    constexpr std::size_t bytes_of_operation = 64;
    const std::size_t bytes = form_->tape.has_terms()
                                  ? form_->tape.bytes()
                                  : bytes_of_operation * static_cast<std::size_t>(form_->tape.size());
    meanwhile.shrink_by(std::min(bytes, meanwhile.bytes()));
    form_->held.add_soon(bytes);
    return std::shared_ptr<const Form>(form_);
  }

 private:
  using Kind = Definition::Kind;

  static constexpr std::string_view velocities_only = "is a momentum; a Lagrangian knows velocities",
                                    momenta_only = "is a velocity; a Hamiltonian knows momenta",
                                    no_velocities = "is a velocity, on which this cannot depend",
                                    no_momenta = "is a momentum, on which this cannot depend",
                                    no_action = "is the action: damping or action_curvature say how it acts",
                                    not_for_invariants = "is the action, which invariants do not know",
                                    no_flow_action = "is the action of mechanics; equations have none";

  void read_flow() {
    const auto known = words(0, {}, {}, no_flow_action);
    const auto rates = texts_by_variable("/equations/", given_.equations, "the rate of");
    for (std::size_t i = 0; i < n(); ++i) {
      const auto& name = given_.variables[i];
      if (rates[i] == nullptr) {
        fault(pointer_to("/equations/", name), "is missing: every variable needs its rate", name);
      } else if (const auto rate = record(pointer_to("/equations/", name), *rates[i], known)) {
        form_->rates.push_back(given_.backward ? -*rate : *rate);
      }
    }
    form_->kind = FormKind::flow;
    Dependence all = 0;
    for (const Symbol& rate : form_->rates) all |= depends_(rate);
    form_->autonomous = (all & tape::on_time) == 0;
  }

  void read_mechanics() {
    if (given_.kind == Kind::potential) return read_potential();
    const bool lagrangian = given_.kind == Kind::lagrangian;
    const std::string pointer = lagrangian ? "/lagrangian" : "/hamiltonian";
    const auto known = words(lagrangian ? 'v' : 'p', momenta_only, velocities_only, {});
    const auto text = record(pointer, given_.formula, known);
    if (!text) return;
    // Lagrangians and Hamiltonians alike are a function F of (q, u, s, t), u = v or p, whose second derivative by u is
    // the metric or its inverse.
    auto& tape = form_->tape;
    const Symbol rest = at_rest(*text);
    std::vector<Symbol> slope = tape::gradient(tape, *text, moving());
    Matrix second(n());
    std::size_t left = most_looked_at;
    for (std::size_t i = 0; i < n(); ++i) {
      try {
        for (const auto& [j, entry] : tape::slopes_of(tape, slope[i], numbers().momentum, n(), left))
          second.row(i).push_back({j, entry});
      } catch (const tape::TooManyOperations&) {
        if (lagrangian) throw;
        return general(*text);
      }
      hold(second.row(i).size());
      if (!lagrangian && second.row(i).empty()) return general(*text);
      if (second.row(i).empty()) {
        return fault(pointer,
                     std::string("is not regular: it is not quadratic in ")
                         .append(velocity_name(given_.variables[i]))
                         .append(", so that its second derivative by the velocities has no inverse"),
                     "a kinetic energy of every velocity");
      }
    }
    if (lagrangian) form_->momenta = slope;
    if (lagrangian && form_->is_compiled()) keep_hessian(second);
    Dependence of_second = 0, of_linear = 0;
    std::vector<Symbol> linear;
    for (std::size_t i = 0; i < n(); ++i) {
      linear.push_back(at_rest(slope[i]));
      if (!is_nothing(linear[i])) of_linear |= Dependence(1) | depends_(linear[i]);
      for (const auto& entry : second.row(i)) of_second |= depends_(entry.value);
    }
    const Symbol by_action = tape::gradient(tape, *text, std::array{numbers().action})[0];
    const Dependence of_action = is_nothing(by_action) ? 0 : depends_(by_action);
    if (!lagrangian) form_->hamiltonian = *text;
    if ((of_second & on_momenta) != 0) {
      if (!lagrangian) return general(*text);
      form_->lagrangian = *text;
      keep_hessian(second);
      return settle(FormKind::lagrangian);
    }
    const Symbol potential = lagrangian ? -rest : rest;
    const bool natural =
        of_linear == 0 && (of_second & (tape::on_time | on_action)) == 0 && (of_action & (on_places | on_momenta)) == 0;
    if (natural && take_action(lagrangian ? -by_action : by_action, potential) && take_metric(second, lagrangian))
      return;
    if (lagrangian) {
      keep_hessian(second);
      const auto raised = inverse_of(second);
      if (!raised) return fault(pointer, "is not regular: its second derivative by the velocities has no inverse");
      // The terms with s are friction α(t) s: q and p move without s, and Herglotz' equations apply as well.
      if (natural && form_->kind == FormKind::contact_linear) form_->lagrangian = *text;
      form_->hamiltonian = legendre(*raised, linear, potential);
    }
    general(form_->hamiltonian);
  }

  void read_potential() {
    const auto known = words(0, no_velocities, no_momenta, no_action);
    const auto potential = record("/potential", given_.formula, known);
    if (potential) form_->potential = *potential;
    Words constants, of_time;
    for (Word word : known.all()) {
      const bool parameter =
          std::ranges::any_of(given_.parameters, [&](const auto& p) { return p.first == word.name; });
      if (!parameter && word.refusal.empty()) word.refusal = "changes; this has to be a number made of parameters";
      constants.add(word);
      if (word.name == "t") word.refusal = {};
      of_time.add(word);
    }
    form_->mass.assign(n(), Symbol(1));
    const auto masses = texts_by_variable("/masses/", given_.masses, "the mass of");
    for (std::size_t i = 0; i < n(); ++i)
      if (masses[i] != nullptr)
        if (const auto mass = record(pointer_to("/masses/", given_.variables[i]), *masses[i], constants))
          form_->mass[i] = *mass;
    for (std::size_t i = 0; i < n(); ++i)
      form_->momenta.push_back(form_->mass[i] * variable(numbers().momentum + static_cast<int>(i)));
    if (given_.damping && (given_.action_curvature || given_.offset))
      fault("/damping", "and action_curvature exclude each other", "one of them");
    if (given_.offset && !given_.action_curvature)
      fault("/offset", "goes with action_curvature only", "{\"action_curvature\": γ, \"offset\": R}");
    if (given_.damping)
      if (const auto damping = record("/damping", *given_.damping, of_time))
        form_->damping = given_.backward ? -*damping : *damping;
    if (given_.action_curvature)
      if (const auto curvature = record("/action_curvature", *given_.action_curvature, constants))
        form_->action_curvature = *curvature;
    if (given_.offset)
      if (const auto offset = record("/offset", *given_.offset, constants)) form_->offset = *offset;
    if (!faults().empty()) return;
    settle(given_.damping            ? FormKind::contact_linear
           : given_.action_curvature ? FormKind::contact_quadratic
                                     : FormKind::separable);
  }

  using Matrix = SymbolMatrix;

  const Numbering& numbers() const { return form_->numbers; }
  std::vector<int> moving() const {
    std::vector<int> all;
    for (std::size_t i = 0; i < n(); ++i) all.push_back(numbers().momentum + static_cast<int>(i));
    return all;
  }
  Symbol with(const Symbol& y, const std::function<Symbol(int)>& other) {
    return tape::Substitution(form_->tape, form_->tape, other)(y);
  }
  Symbol variable(int i) { return Symbol::variable(form_->tape, static_cast<std::size_t>(i)); }
  /// at_rest(y) returns y with velocities or momenta zero.
  Symbol at_rest(const Symbol& y) { return at_rest_(y); }
  Symbol without_action(const Symbol& y) {
    return with(y, [&](int i) { return i == numbers().action ? Symbol(0) : variable(i); });
  }

  /// take_action reads the terms with s off H_s of a natural H = K + V(q, t, s): none, α(t) or γ s. It sets the
  /// potential. False where H_s is anything else.
  bool take_action(const Symbol& slope, const Symbol& potential) {
    auto& tape = form_->tape;
    form_->potential = without_action(potential);
    const Symbol curvature = tape::gradient(tape, slope, std::array{numbers().action})[0];
    if (is_nothing(slope)) {
      form_->kind = FormKind::separable;
      return true;
    }
    if (is_nothing(curvature)) {
      form_->kind = FormKind::contact_linear;
      form_->damping = slope;
      return true;
    }
    constexpr Dependence changing = on_places | on_momenta | on_action | tape::on_time;
    const bool depends = (depends_(form_->potential) & tape::on_time) != 0;
    if ((depends_(curvature) & changing) != 0 || !is_nothing(without_action(slope)) || depends) return false;
    form_->kind = FormKind::contact_quadratic;
    form_->action_curvature = curvature;
    take_offset();
    return true;
  }

  /// take_offset finds −R, the terms of the potential that depend on parameters alone.
  void take_offset() {
    struct Term {
      Symbol value;
      bool negative;
    };
    std::vector<Term> terms{{form_->potential, false}};
    form_->potential = 0;
    while (!terms.empty()) {
      const auto [value, negative] = terms.back();
      terms.pop_back();
      const tape::Node node = value.is_constant() ? tape::Node{} : form_->tape[value.place()];
      if (node.op == tape::Op::add || node.op == tape::Op::subtract) {
        terms.push_back({Symbol::at(form_->tape, node.b), negative != (node.op == tape::Op::subtract)});
        terms.push_back({Symbol::at(form_->tape, node.a), negative});
        continue;
      }
      if (node.op == tape::Op::multiply && form_->tape[node.a].op == tape::Op::constant &&
          form_->tape[node.a].value == -1) {
        terms.push_back({Symbol::at(form_->tape, node.b), !negative});
        continue;
      }
      const bool number = (depends_(value) & (on_places | tape::on_time)) == 0;
      Symbol& sum = number ? form_->offset : form_->potential;
      sum = negative != number ? sum - value : sum + value;
    }
  }

  /// take_metric reads the metric off ∂²L/∂v² or ∂²H/∂p². False where no form has such a metric (a metric that depends
  /// on q needs V(q) alone), or where it takes too many operations and H is known.
  bool take_metric(const Matrix& second, bool lagrangian) try {
    bool constant = true;
    for (std::size_t i = 0; i < n(); ++i)
      for (const auto& entry : second.row(i)) constant = constant && (depends_(entry.value) & on_places) == 0;
    if (is_indefinite(second)) return false;
    if (constant && second.is_diagonal()) {
      for (std::size_t i = 0; i < n(); ++i) {
        const Symbol entry = second.at(i, i);
        form_->mass.push_back(lagrangian ? entry : Symbol(1) / entry);
      }
      settle(form_->kind);
      return true;
    }
    if (lagrangian) keep_hessian(second);
    // Elimination of a positive definite metric needs no pivots but the diagonal.
    for (std::size_t i = 0; i < n(); ++i)
      if (is_nothing(second.at(i, i))) return false;
    if (constant) {
      form_->full_mass = true;
    } else {
      const bool timed = (depends_(form_->potential) & tape::on_time) != 0;
      if (form_->kind != FormKind::separable || timed) return false;
      auto metric = lagrangian ? std::optional(second) : inverse_of(second);
      if (!metric) return false;
      hold(metric->entries());
      form_->metric = std::move(*metric);
    }
    if (!lagrangian) keep_hessian(second);
    settle(constant ? form_->kind : FormKind::metric);
    return true;
  } catch (const tape::TooManyOperations&) {
    if (lagrangian) throw;
    form_->full_mass = false;
    return false;
  }

  /// Charges the memory of so many more matrix entries. Throws MemoryShortage.
  void hold(std::size_t entries) { matrices_.add_soon(entries * sizeof(Matrix::Entry)); }
  void keep_hessian(const Matrix& second) {
    if (!form_->hessian.empty()) return;
    hold(second.entries());
    form_->hessian = second;
  }

  /// legendre returns H of L = ½ vᵀg v + a·v − V.
  Symbol legendre(const Matrix& raised, const std::vector<Symbol>& linear, const Symbol& potential) {
    std::vector<Symbol> kinetic;
    for (std::size_t i = 0; i < n(); ++i)
      kinetic.push_back(variable(numbers().momentum + static_cast<int>(i)) - linear[i]);
    Symbol twice = 0;
    for (std::size_t i = 0; i < n(); ++i)
      for (const auto& [j, entry] : raised.row(i)) twice = twice + kinetic[i] * entry * kinetic[j];
    return Symbol(0.5) * twice + potential;
  }

  void general(const Symbol& hamiltonian) {
    form_->hamiltonian = hamiltonian;
    settle(FormKind::hamiltonian);
  }

  /// settle(kind) sets what follows from the parts: what the motion reads and what it conserves.
  void settle(FormKind kind) {
    form_->kind = kind;
    Dependence all = 0;
    const auto see = [&](const Symbol& part) { all |= depends_(part); };
    if (kind == FormKind::hamiltonian || kind == FormKind::lagrangian) {
      see(form_->hamiltonian);
      see(form_->lagrangian);
    } else {
      see(form_->potential);
      see(form_->damping);
      for (std::size_t i = 0; i < form_->metric.size(); ++i)
        for (const auto& entry : form_->metric.row(i)) see(entry.value);
    }
    form_->autonomous = (all & tape::on_time) == 0;
    form_->constant_damping = kind == FormKind::contact_linear && (depends_(form_->damping) & tape::on_time) == 0;
    form_->reads_action =
        kind == FormKind::contact_quadratic || ((all & on_action) != 0 && kind != FormKind::contact_linear);
    form_->keeps_energy =
        form_->autonomous && !form_->reads_action && kind != FormKind::contact_linear && kind != FormKind::flow;
  }

  void read_invariants() {
    if (given_.invariants.size() > static_cast<std::size_t>(most_invariants))
      fault("/invariants", "are too many", "at most " + std::to_string(most_invariants));
    const auto known = words('p', no_velocities, {}, flow() ? no_flow_action : not_for_invariants);
    for (const auto& invariant : given_.invariants) {
      const std::string& name = invariant.first;
      const std::string pointer = pointer_to("/invariants/", name);
      const bool taken = known.find(name) != nullptr;
      const bool column = name == "energy" || std::ranges::find(column_names(), name) != column_names().end();
      if (!is_name(name) || name.size() > longest_name || taken || column) {
        fault(pointer, "\"" + name.substr(0, 40) + "\" cannot be the name of an invariant",
              "a letter, then letters, digits, _, and nothing else's name");
      } else if (const auto value = record(pointer, invariant.second, known)) {
        form_->invariants.push_back(*value);
        form_->invariant_names.push_back(name);
      }
    }
  }

  Held matrices_ = HeldByThread::take(0);  ///< memory of matrices while the text is read
  tape::Dependences depends_{form_->tape, [this](int i) -> Dependence {
                               if (i >= numbers().parameter) return 0;
                               if (flow() || i < numbers().momentum) return on_places;
                               return i == numbers().action ? on_action : on_momenta;
                             }};
  tape::Substitution at_rest_{form_->tape, form_->tape, [this](int i) {
                                return i >= numbers().momentum && i < numbers().action ? Symbol(0) : variable(i);
                              }};
};

}  // namespace

std::variant<std::shared_ptr<const Form>, std::vector<DefinitionFault>> form_of(const Definition& definition) {
  return Reader(definition).read();
}

}  // namespace least::text
