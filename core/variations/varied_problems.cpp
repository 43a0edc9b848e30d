#include "core/variations/varied_problems.hpp"

#include <algorithm>

#include "core/tape/derivative.hpp"
#include "core/text/lift.hpp"

namespace least::variations {
namespace {

using text::FormKind;

/// MovedForm is a form with one moved parameter, on a tape of its own.
class MovedForm {
 public:
  MovedForm(const text::Form& form, std::span<const double> parameters, std::optional<std::size_t> moved,
            std::size_t room)
      : fold_(form.tape, tape_, [=, this, &form](int i) {
          const auto number = [](int k) { return static_cast<std::size_t>(k); };
          const text::Numbering& numbers = form.numbers;
          const bool flow = form.kind == FormKind::flow;
          if (i >= numbers.parameter) {
            const std::size_t which = number(i - numbers.parameter);
            if (which != moved) return Symbol(parameters[which]);
            return Symbol::variable(tape_, flow ? room : 2 * room + 1);
          }
          if (flow || i < numbers.momentum) return Symbol::variable(tape_, number(i));
          return Symbol::variable(tape_, i == numbers.action ? 2 * room : room + number(i - numbers.momentum));
        }) {}

  Symbol operator()(const Symbol& y) { return fold_(y); }
  std::vector<Symbol> operator()(const std::vector<Symbol>& all) {
    std::vector<Symbol> made;
    made.reserve(all.size());
    for (const Symbol& y : all) made.push_back(fold_(y));
    return made;
  }
  std::vector<Symbol> gradient(const Symbol& y, const std::vector<int>& places) {
    return tape::gradient(tape_, y, places);
  }
  tape::Formula formula(const std::vector<Symbol>& all) {
    std::vector<tape::Index> places;
    places.reserve(all.size());
    for (const Symbol& y : all) places.push_back(y.on(tape_));
    return {tape_, places};
  }
  /// numbers returns the values, with slopes, of symbols that depend on the moved parameter alone.
  std::vector<Slope> numbers(const std::vector<Symbol>& all, const Slope& parameter, std::size_t place) {
    std::vector<Slope> x(place + 1), values(all.size());
    x.back() = parameter;
    formula(all).evaluate(x.data(), Slope(0), values.data());
    return values;
  }

 private:
  tape::Tape tape_;
  tape::Substitution fold_;
};

/// inverse_of returns (A + A′ε)⁻¹ = A⁻¹ − A⁻¹A′A⁻¹ε of a symmetric matrix, row-major.
std::vector<Slope> inverse_of(const std::vector<Slope>& matrix, std::size_t n) {
  std::vector<double> plain;
  plain.reserve(matrix.size());
  for (const Slope& entry : matrix) plain.push_back(entry.value);
  detail::invert(n, plain.data());
  std::vector<Slope> inverse(plain.begin(), plain.end());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = 0; l < n; ++l)
          inverse[i * n + j].slope[0] -= plain[i * n + k] * matrix[k * n + l].slope[0] * plain[l * n + j];
  return inverse;
}

}  // namespace

VariedFormulas::VariedFormulas(const text::Form& form, std::span<const double> parameters,
                               std::optional<std::size_t> moved, std::size_t room)
    : coordinates(form.coordinates), reads_action(form.reads_action) {
  MovedForm fold(form, parameters, moved, room);
  if (moved) parameter = {parameters[*moved], {1}};
  const std::size_t n = coordinates;
  std::vector<int> places;
  for (std::size_t i = 0; i < n; ++i) places.push_back(static_cast<int>(i));
  const auto numbers = [&](const std::vector<Symbol>& all) { return fold.numbers(all, parameter, 2 * room + 1); };
  if (form.kind == FormKind::flow) {
    rates = fold.formula(fold(form.rates));
    return;
  }
  if (form.kind == FormKind::hamiltonian) {
    for (std::size_t i = 0; i < n; ++i) places.push_back(static_cast<int>(room + i));
    places.push_back(static_cast<int>(2 * room));
    const Symbol h = fold(form.hamiltonian);
    hamiltonian = fold.formula({h});
    slopes = fold.formula(fold.gradient(h, places));
    lift = text::Lift::of(form, parameters, moved);
    return;
  }
  const Symbol v = fold(form.potential), friction = fold(form.damping);
  potential = fold.formula({v});
  gradient = fold.formula(fold.gradient(v, places));
  damping = fold.formula({friction});
  metric = fold.formula(fold(form.metric.written_out()));
  inverse_mass.assign(std::max(room, n), Slope(1));
  const std::vector<Slope> masses = numbers(fold(form.mass));
  for (std::size_t i = 0; i < masses.size(); ++i) inverse_mass[i] = Slope(1) / masses[i];
  if (form.constant_damping) alpha = numbers({friction})[0];
  gamma = numbers({fold(form.action_curvature)})[0];
  offset = numbers({fold(form.offset)})[0];
  if (!form.full_mass) return;
  full_mass = true;
  const std::vector<Slope> given = numbers(fold(form.hessian.written_out()));
  const std::vector<Slope> inverse = inverse_of(given, n);
  mass_matrix = form.momenta.empty() ? inverse : given;
  inverse_mass_matrix = form.momenta.empty() ? given : inverse;
}

}  // namespace least::variations
