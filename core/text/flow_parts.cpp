#include "core/text/flow_parts.hpp"

#include <algorithm>
#include <utility>

#include "core/tape/derivative.hpp"

namespace least::text {
namespace {

constexpr tape::Index most_of_rates = 1 << 17;

/// RatesInParts holds the rates on a tape of its own, with numbers in the place of parameters.
class RatesInParts {
 public:
  RatesInParts(const Form& form, std::span<const double> parameters, std::optional<std::size_t> moved)
      : n_(form.coordinates) {
    tape_.bound(most_of_rates);
    tape::Substitution fold(form.tape, tape_, [&](int i) {
      if (i < form.numbers.parameter) return Symbol::variable(tape_, static_cast<std::size_t>(i));
      const auto which = static_cast<std::size_t>(i - form.numbers.parameter);
      return which == moved ? Symbol::variable(tape_, n_) : Symbol(parameters[which]);
    });
    for (const Symbol& rate : form.rates) {
      rates_.push_back(fold(rate));
      reads_.push_back(variables_of(rates_.back()));
    }
  }
  RatesInParts(const RatesInParts&) = delete;
  RatesInParts& operator=(const RatesInParts&) = delete;

  std::vector<FlowParts::Part> parts() {
    std::vector<FlowParts::Part> all;
    for (std::size_t i = 0; i < n_; ++i) {
      const auto found = std::ranges::find_if(all, [&](const FlowParts::Part& part) { return goes_with(i, part.of); });
      (found == all.end() ? all.emplace_back() : *found).of.push_back(i);
    }
    for (FlowParts::Part& part : all) {
      std::vector<tape::Index> places, slopes;
      for (const std::size_t i : part.of) {
        const Symbol slope = tape::gradient(tape_, rates_[i], std::array{static_cast<int>(i)})[0];
        part.affine = part.affine && !variables_of(slope)[i] && !switches_with(i);
        places.push_back(rates_[i].on(tape_));
        slopes.push_back(slope.on(tape_));
      }
      places.insert(places.end(), slopes.begin(), slopes.end());
      part.rates = tape::Formula(tape_, places);
    }
    return all;
  }

 private:
  std::vector<bool> variables_of(const Symbol& y) const {
    std::vector<bool> all(n_ + 1, false);  // the last is the moved parameter
    if (y.is_constant()) return all;
    for (const tape::Index part : tape::parts_of(tape_, y.place()))
      if (tape_[part].op == tape::Op::variable) all[static_cast<std::size_t>(tape_[part].value)] = true;
    return all;
  }
  bool goes_with(std::size_t i, const std::vector<std::size_t>& others) const {
    return std::ranges::none_of(others, [&](std::size_t j) { return reads_[i][j] || reads_[j][i]; });
  }
  /// switches_with(i) tells whether rate i has a case distinction in its own variable, as |x| does: its slope does not
  /// show it.
  bool switches_with(std::size_t i) {
    if (rates_[i].is_constant()) return false;
    return std::ranges::any_of(tape::parts_of(tape_, rates_[i].place()), [&](tape::Index part) {
      return tape_[part].op == tape::Op::select && variables_of(Symbol::at(tape_, tape_[part].a))[i];
    });
  }

  std::size_t n_;
  tape::Tape tape_;
  std::vector<Symbol> rates_;
  std::vector<std::vector<bool>> reads_;
};

/// with_momenta returns the form of H = p·X.
Form with_momenta(const Form& flow) {
  Form made;
  made.kind = FormKind::hamiltonian;
  made.autonomous = flow.autonomous;
  made.coordinates = flow.coordinates;
  made.numbers = Numbering::of_mechanics(flow.coordinates);
  made.tape.bound(most_of_rates);
  const auto variable = [&](int i) { return Symbol::variable(made.tape, static_cast<std::size_t>(i)); };
  tape::Substitution moved(flow.tape, made.tape, [&](int i) {
    return variable(i < flow.numbers.parameter ? i : made.numbers.parameter + i - flow.numbers.parameter);
  });
  for (std::size_t i = 0; i < flow.coordinates; ++i)
    made.hamiltonian = made.hamiltonian + variable(made.numbers.momentum + static_cast<int>(i)) * moved(flow.rates[i]);
  return made;
}

}  // namespace

std::variant<FlowParts, std::string> flow_parts(const Form& form, std::span<const double> parameters,
                                                std::optional<std::size_t> moved) {
  if (form.kind != FormKind::flow) return "it is not given by equations alone";
  if (form.coordinates > FlowParts::most_variables)
    return "it has more than " + std::to_string(FlowParts::most_variables) + " variables";
  try {
    FlowParts made;
    made.variables = form.coordinates;
    made.autonomous = form.autonomous;
    made.parts = RatesInParts(form, parameters, moved).parts();
    if (form.coordinates <= Lift::most_coordinates) made.lift = Lift::of(with_momenta(form), parameters, moved);
    return made;
  } catch (const tape::TooManyOperations&) {
    return "its derivatives take too many operations";
  }
}

}  // namespace least::text
