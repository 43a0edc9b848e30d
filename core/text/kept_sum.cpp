#include "core/text/kept_sum.hpp"

#include <charconv>

namespace least::text {
namespace {

/// places_of returns, by number of a name, the place on the tape of its meaning; none for names that the sum does not
/// use.
std::variant<std::vector<tape::Index>, Fault> places_of(const KeptSum& sum, const std::vector<std::string>& names,
                                                        tape::Tape& tape, const Words& words) {
  std::vector<tape::Index> places(names.size(), tape::none);
  for (const KeptSum::Shape& shape : sum.shapes)
    for (const std::uint32_t number : shape.given) {
      if (places[number] != tape::none) continue;
      const std::string& name = names[number];
      if (double value = 0; std::from_chars(name.data(), name.data() + name.size(), value).ec == std::errc()) {
        places[number] = Symbol(value).on(tape);  // the value of an index
        continue;
      }
      const Word* const known = words.find(name);
      if (!known) return Fault{0, "nobody knows the name " + name};
      if (!known->refusal.empty()) return Fault{0, name + " " + std::string(known->refusal)};
      places[number] = known->meaning.on(tape);
    }
  return places;
}

/// formula_of records the common formula of a shape; argument k is the name a[k + 1].
std::variant<Symbol, Fault> formula_of(const KeptSum::Shape& shape, tape::Tape& formula) {
  auto parsed = Expression::parse(shape.text);
  if (auto* fault = std::get_if<Fault>(&parsed)) return std::move(*fault);
  std::vector<std::string> names;
  names.reserve(shape.arguments);
  Words words;
  for (std::size_t k = 0; k < shape.arguments; ++k)
    words.add({names.emplace_back(element_name("a", static_cast<std::int64_t>(k) + 1)), Symbol::variable(formula, k)});
  return std::get<Expression>(parsed).record(formula, words);
}

}  // namespace

std::variant<Symbol, Fault> record_sum(const KeptSums& sums, std::size_t which, tape::Tape& tape, const Words& words,
                                       std::size_t& summed) {
  const KeptSum& sum = sums.all[which];
  auto found = places_of(sum, sums.names.all(), tape, words);
  if (auto* fault = std::get_if<Fault>(&found)) return std::move(*fault);
  const auto& places = std::get<std::vector<tape::Index>>(found);
  Symbol whole = 0;
  for (const KeptSum::Shape& shape : sum.shapes) {
    tape::Tape formula;
    auto recorded = formula_of(shape, formula);
    if (auto* fault = std::get_if<Fault>(&recorded)) return std::move(*fault);
    const Symbol& term = std::get<Symbol>(recorded);
    const std::size_t operations = static_cast<std::size_t>(formula.size()) - shape.arguments + 1;  // and the addition
    if ((summed += operations * shape.terms) > most_kept)
      return Fault{0, "takes too many operations", std::to_string(most_kept) + " in the terms of all sums"};
    if (term.is_constant()) {
      whole = whole + Symbol(static_cast<double>(shape.terms)) * term;
      continue;
    }
    tape::Terms made;
    for (tape::Index i = 0; i < formula.size(); ++i) made.formula.push_back(formula[i]);
    made.results = {term.place()};
    made.arguments = static_cast<tape::Index>(shape.arguments);
    made.count = static_cast<tape::Index>(shape.terms);
    made.sums = 1;
    made.given.reserve(shape.given.size());
    for (std::size_t k = 0; k < shape.arguments; ++k)
      for (std::size_t t = 0; t < shape.terms; ++t) made.given.push_back(places[shape.given[t * shape.arguments + k]]);
    made.into.assign(shape.terms, 0);
    whole = whole + Symbol::total(tape, tape.keep(std::move(made)), 0);
  }
  return whole;
}

}  // namespace least::text
