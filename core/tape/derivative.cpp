#include "core/tape/derivative.hpp"

#include <algorithm>

#include "core/tape/terms.hpp"

namespace least::tape {
namespace {

/// Whether a node depends on the time or on a variable.
bool varies(const Tape& tape, Index i) {
  return std::ranges::any_of(parts_of(tape, i),
                             [&](Index k) { return tape[k].op == Op::time || tape[k].op == Op::variable; });
}

bool is_zero(const Symbol& x) { return x.is_constant() && x.constant() == 0; }

std::vector<Index> parts_of(const Tape& tape, const Symbol& y) {
  return y.is_constant() ? std::vector<Index>() : parts_of(tape, y.place());
}

/// Returns, by node up to the last of `parts`, whether it depends on a variable that is `asked` for.
template <class Asked>
std::vector<bool> depending(const Tape& tape, const std::vector<Index>& parts, const Asked& asked) {
  std::vector<bool> all(nth(parts.back() + 1), false);
  for (const Index i : parts) {
    const Node& node = tape[i];
    bool depends = node.op == Op::variable && asked(static_cast<int>(node.value));
    tape.for_each_operand(node, [&](Index part) { depends = depends || all[nth(part)]; });
    all[nth(i)] = depends;
  }
  return all;
}

/// The adjoints `of` the sums of one Terms. They are complete when the walk back arrives at `first`, the first total of
/// these terms on the tape.
struct Adjoints {
  Index first = none;
  std::vector<Symbol> of;
};

/// Reverse mode: calls see(number, ∂y/∂variable) for every variable that y depends on, but where terms are kept,
/// perhaps only for those that are `asked` for. `parts` are the parts of y.
template <class Asked, class See>
void walk_back(Tape& tape, const Symbol& y, const std::vector<Index>& parts, const Asked& asked, const See& see) {
  if (y.is_constant()) return;
  std::vector<Symbol> adjoint(parts.size());
  adjoint.back() = 1;
  const auto number = [&](Index i) {
    return static_cast<std::size_t>(std::ranges::lower_bound(parts, i) - parts.begin());
  };
  std::map<Index, Adjoints> totals;
  std::vector<bool> wanted;
  if (tape.has_terms())
    for (const Index i : parts)
      if (tape[i].op == Op::total && totals.try_emplace(static_cast<Index>(tape[i].low), Adjoints{i, {}}).second)
        totals[static_cast<Index>(tape[i].low)].of.resize(nth(tape.terms(tape[i]).sums));
  if (!totals.empty()) wanted = depending(tape, parts, asked);
  for (std::size_t n = parts.size(); n-- > 0;) {
    const Index i = parts[n];
    const Symbol down = adjoint[n];
    if (!totals.empty() && tape[i].op == Op::total) {
      const auto terms = static_cast<Index>(tape[i].low);
      Adjoints& known = totals[terms];
      known.of[static_cast<std::size_t>(tape[i].value)] = down;
      if (known.first != i || std::ranges::all_of(known.of, is_zero)) continue;
      for (const auto& [operand, slope] :
           slopes_of_terms(tape, terms, known.of, [&](Index k) { return wanted[nth(k)]; }))
        adjoint[number(operand)] = adjoint[number(operand)] + slope;
      continue;
    }
    if (is_zero(down)) continue;
    const Node node = tape[i];  // a copy: writing moves the nodes
    const Symbol x = Symbol::at(tape, i);
    const auto part = [&](Index k) { return Symbol::at(tape, k); };
    const auto add = [&](Index k, const Symbol& slope) { adjoint[number(k)] = adjoint[number(k)] + slope; };
    switch (node.op) {
      case Op::constant:
      case Op::time:
      case Op::total:
        break;
      case Op::variable:
        see(static_cast<int>(node.value), down);
        break;
      case Op::add:
        add(node.a, down);
        add(node.b, down);
        break;
      case Op::subtract:
        add(node.a, down);
        add(node.b, -down);
        break;
      case Op::multiply:
        if (node.a == node.b) {
          add(node.a, down * Symbol(2) * part(node.a));  // 2 `down` is one node for all squares of a sum
        } else {
          add(node.a, down * part(node.b));
          add(node.b, down * part(node.a));
        }
        break;
      case Op::divide:
        add(node.a, down / part(node.b));
        add(node.b, -(down * (x / part(node.b))));
        break;
      case Op::power:
        add(node.a, down * (Symbol(node.value) * pow(part(node.a), node.value - 1)));
        break;
      case Op::raise:
        add(node.a, down * (part(node.b) * raise(part(node.a), part(node.b) - Symbol(1))));
        if (varies(tape, node.b)) add(node.b, down * (x * log(part(node.a))));
        break;
      case Op::sqrt:
        add(node.a, down * (Symbol(0.5) * pow(part(node.a), -0.5)));
        break;
      case Op::exp:
        add(node.a, down * x);
        break;
      case Op::log:
        add(node.a, down / part(node.a));
        break;
      case Op::sin:
        add(node.a, down * cos(part(node.a)));
        break;
      case Op::cos:
        add(node.a, -(down * sin(part(node.a))));
        break;
      case Op::tan:
        add(node.a, down * (Symbol(1) + x * x));
        break;
      case Op::sinh:
        add(node.a, down * cosh(part(node.a)));
        break;
      case Op::cosh:
        add(node.a, down * sinh(part(node.a)));
        break;
      case Op::tanh:
        add(node.a, down * (Symbol(1) - x * x));
        break;
      case Op::atan:
        add(node.a, down / (Symbol(1) + part(node.a) * part(node.a)));
        break;
      case Op::asin:
        add(node.a, down * pow(Symbol(1) - part(node.a) * part(node.a), -0.5));
        break;
      case Op::acos:
        add(node.a, -(down * pow(Symbol(1) - part(node.a) * part(node.a), -0.5)));
        break;
      case Op::select: {
        const Symbol negative = part(node.a);
        add(node.b, select(negative < Symbol(0), down, 0));
        add(node.c, select(negative < Symbol(0), 0, down));
        break;
      }
    }
  }
}

}  // namespace

std::vector<Index> parts_of(const Tape& tape, Index whole) {
  // Resetting what was seen costs less than a new list per call on a large tape: all are false between calls.
  thread_local std::vector<bool> seen;
  if (seen.size() < nth(tape.size())) seen.resize(nth(tape.size()), false);
  std::vector<Index> parts{whole};
  seen[nth(whole)] = true;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    tape.for_each_operand(tape[parts[k]], [&](Index part) {
      if (seen[nth(part)]) return;
      seen[nth(part)] = true;
      parts.push_back(part);
    });
  }
  for (const Index part : parts) seen[nth(part)] = false;
  std::ranges::sort(parts);
  return parts;
}

Dependence Dependences::operator()(const Symbol& y) {
  if (y.is_constant()) return 0;
  for (Index i = static_cast<Index>(of_.size()); i <= y.place(); ++i) {
    const Node& node = tape_[i];
    Dependence of = node.op == Op::time ? on_time : 0;
    if (node.op == Op::variable) of = kind_(static_cast<int>(node.value));
    tape_.for_each_operand(node, [&](Index part) { of |= of_[nth(part)]; });
    of_.push_back(of);
  }
  return of_[nth(y.place())];
}

std::vector<Symbol> gradient(Tape& tape, const Symbol& y, std::span<const int> variables) {
  std::vector<Symbol> slopes(variables.size());
  const auto asked = [&](int number) { return std::ranges::find(variables, number) != variables.end(); };
  walk_back(tape, y, parts_of(tape, y), asked, [&](int number, const Symbol& slope) {
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (variables[k] == number) slopes[k] = slope;
  });
  return slopes;
}

std::vector<std::pair<std::size_t, Symbol>> slopes_of(Tape& tape, const Symbol& y, int first, std::size_t count,
                                                      std::size_t& left) {
  std::vector<std::pair<std::size_t, Symbol>> slopes;
  const std::vector<Index> parts = parts_of(tape, y);
  if (parts.size() > left) throw TooManyOperations();
  left -= parts.size();
  const auto asked = [&](int number) { return number >= first && static_cast<std::size_t>(number - first) < count; };
  walk_back(tape, y, parts, asked, [&](int number, const Symbol& slope) {
    if (asked(number) && !is_zero(slope)) slopes.emplace_back(static_cast<std::size_t>(number - first), slope);
  });
  std::ranges::sort(slopes, {}, &std::pair<std::size_t, Symbol>::first);
  return slopes;
}

std::vector<Index> Substitution::unknown_parts(Index whole) {
  std::vector<Index> parts;
  const auto look_at = [&](Index part) {
    if (known_[nth(part)]) return;
    known_[nth(part)] = true;
    parts.push_back(part);
  };
  look_at(whole);
  for (std::size_t looked = 0; looked < parts.size();) from_.for_each_operand(from_[parts[looked++]], look_at);
  std::ranges::sort(parts);
  return parts;
}

Symbol Substitution::at(Index place) {
  if (made_.size() <= nth(place)) {
    made_.resize(nth(from_.size()));
    known_.resize(made_.size(), false);
  }
  for (const Index i : unknown_parts(place)) {
    const Node node = from_[i];  // both tapes may be one
    const auto a = [&] { return made_[nth(node.a)]; };
    const auto b = [&] { return made_[nth(node.b)]; };
    Symbol& made = made_[nth(i)];
    switch (node.op) {
      case Op::constant:
        made = Symbol(DoubleDouble(node.value, node.low));
        break;
      case Op::time:
        made = Symbol::time(to_);
        break;
      case Op::variable:
        made = in_place_of_(static_cast<int>(node.value));
        break;
      case Op::add:
        made = a() + b();
        break;
      case Op::subtract:
        made = a() - b();
        break;
      case Op::multiply:
        made = a() * b();
        break;
      case Op::divide:
        made = a() / b();
        break;
      case Op::power:
        made = pow(a(), node.value);
        break;
      case Op::raise:
        made = powers_ == Powers::kept ? raise(a(), b()) : pow(a(), b());
        break;
      case Op::sqrt:
        made = sqrt(a());
        break;
      case Op::exp:
        made = exp(a());
        break;
      case Op::log:
        made = log(a());
        break;
      case Op::sin:
        made = sin(a());
        break;
      case Op::cos:
        made = cos(a());
        break;
      case Op::tan:
        made = tan(a());
        break;
      case Op::sinh:
        made = sinh(a());
        break;
      case Op::cosh:
        made = cosh(a());
        break;
      case Op::tanh:
        made = tanh(a());
        break;
      case Op::atan:
        made = atan(a());
        break;
      case Op::asin:
        made = asin(a());
        break;
      case Op::acos:
        made = acos(a());
        break;
      case Op::select:
        made = select(a() < Symbol(0), b(), made_[nth(node.c)]);
        break;
      case Op::total:
        made = total(node);
        break;
    }
  }
  return made_[nth(place)];
}

Symbol Substitution::total(const Node& node) {
  const auto number = static_cast<Index>(node.low), sum = static_cast<Index>(node.value);
  if (totals_ == Totals::written_out) {
    const auto [sums, is_new] = sums_.try_emplace(number, nth(from_.terms(number).sums), Symbol(0));
    if (is_new) write_out(number, sums->second);
    return sums->second[nth(sum)];
  }
  const auto [terms, is_new] = terms_.try_emplace(number, none);
  if (is_new) terms->second = kept_terms(number);
  return Symbol::total(to_, terms->second, sum);
}

Index Substitution::kept_terms(Index number) {
  Terms terms = from_.terms(number);  // a copy: both tapes may be one
  std::vector<Index> place(nth(terms.operands.back()) + 1);
  for (const Index operand : terms.operands) place[nth(operand)] = made_[nth(operand)].on(to_);
  for (Index& given : terms.given) given = place[nth(given)];
  return to_.keep(std::move(terms));
}

void Substitution::write_out(Index number, std::vector<Symbol>& sums) {
  const Terms& terms = from_.terms(number);
  const Tape formula = tape_of(terms);
  const std::size_t count = nth(terms.count);
  for (std::size_t t = 0; t < count; ++t) {
    Substitution one(formula, to_,
                     [&](int k) { return made_[nth(terms.given[static_cast<std::size_t>(k) * count + t])]; });
    for (std::size_t r = 0; r < terms.results.size(); ++r)
      if (const Index sum = terms.into[r * count + t]; sum != none)
        sums[nth(sum)] = sums[nth(sum)] + one.at(terms.results[r]);
  }
}

std::size_t operations_written_out(const Tape& tape) {
  std::size_t all = nth(tape.size());
  // Terms that share parts take fewer operations than the sum of each by itself, but not many times fewer.
  constexpr std::size_t shared = 2;
  std::vector<Index> seen;
  for (Index i = 0; i < tape.size(); ++i) {
    const auto number = static_cast<Index>(tape[i].low);
    if (tape[i].op != Op::total || std::ranges::find(seen, number) != seen.end()) continue;
    seen.push_back(number);
    const Terms& terms = tape.terms(number);
    const auto is_operation = [](const Node& node) { return node.op != Op::variable && node.op != Op::constant; };
    const auto operations = static_cast<std::size_t>(std::ranges::count_if(terms.formula, is_operation));
    all += nth(terms.count) * (operations + terms.results.size()) / shared;
  }
  return all;
}

PlainTape written_out(const Tape& tape, std::span<const Index> roots, Index most) {
  if (operations_written_out(tape) > nth(most)) throw TooManyOperations();
  PlainTape plain;
  plain.tape.bound(most);
  Substitution write(
      tape, plain.tape, [&](int i) { return Symbol::variable(plain.tape, static_cast<std::size_t>(i)); },
      Totals::written_out);
  plain.roots.reserve(roots.size());
  for (const Index root : roots) plain.roots.push_back(write.at(root).on(plain.tape));
  return plain;
}

bool has_moving_exponents(const Tape& tape) {
  for (Index i = 0; i < tape.size(); ++i)
    if (tape[i].op == Op::raise) return true;
  return false;
}

PlainTape with_exponentials(const Tape& tape, std::span<const Index> roots) {
  PlainTape plain;
  Substitution write(
      tape, plain.tape, [&](int i) { return Symbol::variable(plain.tape, static_cast<std::size_t>(i)); }, Totals::kept,
      Powers::exponentials);
  plain.roots.reserve(roots.size());
  for (const Index root : roots) plain.roots.push_back(write.at(root).on(plain.tape));
  return plain;
}

}  // namespace least::tape
