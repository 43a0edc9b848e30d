#include "core/text/lift.hpp"

#include <algorithm>
#include <numeric>

#include "core/tape/derivative.hpp"

namespace least::text {
namespace {

using tape::Dependence;

/// What a coefficient may depend on; parameters do not count, as they are numbers of a scene.
constexpr Dependence reads_places = 1, reads_momenta = 2, reads_s = 4;

bool vanishes(const Symbol& y) { return y.is_constant() && y.constant() == 0; }

/// Parts holds the parts of H on a tape of its own with the variables q (from 0), s, the moved parameter, p, all
/// parameters.
class Parts {
 public:
  explicit Parts(const Form& form) : Parts(form, {}, {}) {}
  Parts(const Form& form, std::span<const double> numbers, std::optional<std::size_t> moved)
      : reads_action(form.reads_action), n_(form.coordinates) {
    tape::Substitution fold(form.tape, tape_, [&](int i) {
      const Numbering& of = form.numbers;
      if (i < of.momentum) return variable(static_cast<std::size_t>(i));
      if (i < of.action) return variable(first_momentum() + static_cast<std::size_t>(i - of.momentum));
      if (i == of.action) return variable(n_);
      const auto which = static_cast<std::size_t>(i - of.parameter);
      if (which == moved) return variable(n_ + 1);
      return numbers.empty() ? variable(first_momentum() + n_ + which) : Symbol(numbers[which]);
    });
    const Symbol h = fold(form.hamiltonian);
    std::vector<int> momenta(n_);
    std::iota(momenta.begin(), momenta.end(), static_cast<int>(first_momentum()));
    const std::vector<Symbol> slopes = tape::gradient(tape_, h, momenta);
    for (std::size_t i = 0; i < n_; ++i) {
      const std::vector<Symbol> row = tape::gradient(tape_, slopes[i], momenta);
      second.insert(second.end(), row.begin(), row.end());
      field.push_back(at_rest_(slopes[i]));
    }
    kinetic = !std::ranges::all_of(second, vanishes);
    take_rest(at_rest_(h));
    acts = !vanishes(field.back()) || std::ranges::any_of(field, [&](const Symbol& x) { return reads(x, reads_s); });
    if (!acts) field.pop_back();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  bool reads_action;
  std::vector<Symbol> second;  ///< ∂²H/∂p², row by row
  std::vector<Symbol> field;   ///< X and, where `acts`, g
  Symbol potential = 0;
  bool kinetic = false, acts = false;

  bool reads(const Symbol& y, Dependence what) { return (depends_(y) & what) != 0; }
  Dependence dependence(const Symbol& y) { return depends_(y); }
  std::size_t variables() const { return n_ + 2; }
  std::vector<Symbol> gradient(const Symbol& y, std::size_t count) {
    std::vector<int> places(count);
    std::iota(places.begin(), places.end(), 0);
    return tape::gradient(tape_, y, places);
  }
  /// at_origin returns symbols at q = 0, s = 0.
  std::vector<Symbol> at_origin(const std::vector<Symbol>& all) {
    tape::Substitution at(tape_, tape_, [this](int i) {
      const auto k = static_cast<std::size_t>(i);
      return k <= n_ ? Symbol(0) : variable(k);
    });
    std::vector<Symbol> made;
    made.reserve(all.size());
    for (const Symbol& y : all) made.push_back(at(y));
    return made;
  }
  std::vector<Symbol> jacobian() {
    std::vector<Symbol> all;
    for (const Symbol& y : field) {
      const std::vector<Symbol> row = gradient(y, field.size());
      all.insert(all.end(), row.begin(), row.end());
    }
    return all;
  }
  tape::Formula formula(const std::vector<Symbol>& all) {
    std::vector<tape::Index> places;
    places.reserve(all.size());
    for (const Symbol& y : all) places.push_back(y.on(tape_));
    return {tape_, places};
  }
  /// numbers returns the values of symbols that depend on parameters alone.
  VariedNumbers numbers(const std::vector<Symbol>& all, const Slope& parameter) {
    std::vector<Slope> point(variables()), values(all.size());
    point.back() = parameter;
    formula(all).evaluate(point.data(), Slope(0), values.data());
    return VariedNumbers(std::move(values));
  }

 private:
  std::size_t first_momentum() const { return n_ + 2; }
  Symbol variable(std::size_t i) { return Symbol::variable(tape_, i); }
  /// H at p = 0 is V − g: the terms of this sum without s form V, provided there is a kinetic energy.
  void take_rest(const Symbol& rest) {
    struct Term {
      Symbol value;
      bool negative;
    };
    std::vector<Term> terms{{rest, false}};
    Symbol g = 0;
    while (!terms.empty()) {
      const auto [value, negative] = terms.back();
      terms.pop_back();
      const tape::Node node = value.is_constant() ? tape::Node{} : tape_[value.place()];
      if (node.op == tape::Op::add || node.op == tape::Op::subtract) {
        terms.push_back({Symbol::at(tape_, node.b), negative != (node.op == tape::Op::subtract)});
        terms.push_back({Symbol::at(tape_, node.a), negative});
      } else if (kinetic && !reads(value, reads_s)) {
        potential = negative ? potential - value : potential + value;
      } else {
        g = negative ? g + value : g - value;
      }
    }
    field.push_back(g);
  }

  std::size_t n_;
  tape::Tape tape_;
  tape::Dependences depends_{tape_, [this](int i) -> Dependence {
                               const auto k = static_cast<std::size_t>(i);
                               if (k < n_) return reads_places;
                               if (k == n_) return reads_s;
                               return k >= first_momentum() && k < first_momentum() + n_ ? reads_momenta : 0;
                             }};
  tape::Substitution at_rest_{tape_, tape_, [this](int i) {
                                const auto k = static_cast<std::size_t>(i);
                                return k >= first_momentum() && k < first_momentum() + n_ ? Symbol(0) : variable(k);
                              }};
};

bool is_constant(Parts& parts, const std::vector<Symbol>& all) {
  return std::ranges::all_of(all, [&](const Symbol& y) { return parts.dependence(y) == 0; });
}
bool is_linear_field(Parts& parts) {
  return is_constant(parts, parts.jacobian()) && is_constant(parts, parts.at_origin(parts.field));
}

std::string objection_to(Parts& parts, const std::vector<std::string>& variables) {
  const std::size_t n = variables.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) {
      const Dependence on = parts.dependence(parts.second[i * n + j]);
      if (on == 0) continue;
      const std::string p = momentum_name(variables[i]);
      if ((on & reads_momenta) != 0) return "that is not quadratic in " + p;
      std::string words = "whose coefficient of ";
      words += p;
      words += i == j ? "^2" : "*" + momentum_name(variables[j]);
      words += " depends on ";
      return words += (on & reads_places) != 0 ? "the place" : (on & reads_s) != 0 ? "s" : "the time";
    }
  return {};
}

constexpr const char* and_who_takes_it = " (contact_gauss takes that)";

}  // namespace

VariedNumbers::VariedNumbers(std::vector<Slope> all) : all_(std::move(all)) {
  plain_.reserve(all_.size());
  for (const Slope& x : all_) plain_.push_back(x.value);
}

std::string Lift::objection(const Form& form, const std::vector<std::string>& variables) {
  if (form.coordinates > most_coordinates)
    return "of more coordinates than the " + std::to_string(most_coordinates) + " that lifted_splitting solves for";
  try {
    Parts parts(form);
    const std::string found = objection_to(parts, variables);
    return found.empty() ? found : found + and_who_takes_it;
  } catch (const tape::TooManyOperations&) {
    return "whose derivatives take too many operations for lifted_splitting";
  }
}

bool Lift::is_linear(const Form& form) {
  Parts parts(form);
  return is_linear_field(parts);
}

std::shared_ptr<const Lift> Lift::of(const Form& form, std::span<const double> parameters,
                                     std::optional<std::size_t> moved) {
  if (form.kind != FormKind::hamiltonian || form.forced || form.coordinates > most_coordinates) return nullptr;
  try {
    const std::size_t n = form.coordinates;
    Parts parts(form, parameters, moved);
    if (!is_constant(parts, parts.second)) return nullptr;
    auto made = std::make_shared<Lift>();
    made->coordinates = n;
    made->width = parts.field.size();
    made->variables = parts.variables();
    made->reads_action = parts.reads_action;
    made->acts = parts.acts;
    if (moved) made->parameter = {parameters[*moved], {1}};
    made->kinetic = parts.kinetic;
    std::vector<Symbol> mass;
    for (std::size_t i = 0; i < n; ++i) {
      mass.push_back(parts.second[i * n + i]);
      for (std::size_t j = 0; j < n; ++j)
        made->diagonal = made->diagonal && (i == j || vanishes(parts.second[i * n + j]));
    }
    // Both triangles get the same entries: steps are symplectic only where the matrix is exactly symmetric.
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j) parts.second[i * n + j] = parts.second[j * n + i];
    made->inverse_mass = parts.numbers(made->diagonal ? mass : parts.second, made->parameter);
    made->kicks = !vanishes(parts.potential);
    std::vector<Symbol> kick = parts.gradient(parts.potential, n);
    if (made->reads_action) kick.push_back(parts.potential);
    made->kick = parts.formula(kick);
    made->rates = parts.formula(parts.field);
    const std::vector<Symbol> jacobian = parts.jacobian();
    std::vector<Symbol> jets = parts.field;
    jets.insert(jets.end(), jacobian.begin(), jacobian.end());
    made->jets = parts.formula(jets);
    made->linear = is_linear_field(parts);
    if (made->linear) {
      made->matrix = parts.numbers(jacobian, made->parameter);
      made->offset = parts.numbers(parts.at_origin(parts.field), made->parameter);
    }
    return made;
  } catch (const tape::TooManyOperations&) {
    return nullptr;
  }
}

}  // namespace least::text
