#include "core/tape/derivative.hpp"

#include <algorithm>

namespace least::tape {
namespace {

std::size_t nth(Index i) { return static_cast<std::size_t>(i); }

/// Whether a value is none that is known beforehand.
bool varies(const Tape& tape, Index i) {
  return std::ranges::any_of(parts_of(tape, i),
                             [&](Index k) { return tape[k].op == Op::time || tape[k].op == Op::variable; });
}

bool is_zero(const Symbol& x) { return x.is_constant() && x.constant() == 0; }

std::vector<Index> parts_of(const Tape& tape, const Symbol& y) {
  return y.is_constant() ? std::vector<Index>() : parts_of(tape, y.place());
}

/// Calls `see(number, slope)` for every variable that y, with these parts, is made of.
template <class See>
void walk_back(Tape& tape, const Symbol& y, const std::vector<Index>& parts, const See& see) {
  if (y.is_constant()) return;
  std::vector<Symbol> adjoint(parts.size());
  adjoint.back() = 1;
  const auto number = [&](Index i) {
    return static_cast<std::size_t>(std::ranges::lower_bound(parts, i) - parts.begin());
  };
  for (std::size_t n = parts.size(); n-- > 0;) {
    const Index i = parts[n];
    const Symbol down = adjoint[n];
    if (is_zero(down)) continue;
    const Node node = tape[i];  // what follows may move them
    const Symbol x = Symbol::at(tape, i);
    const auto part = [&](Index k) { return Symbol::at(tape, k); };
    const auto add = [&](Index k, const Symbol& slope) { adjoint[number(k)] = adjoint[number(k)] + slope; };
    switch (node.op) {
      case Op::constant:
      case Op::time:
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
          add(node.a, down * Symbol(2) * part(node.a));  // twice `down` is one number for all squares of a sum
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
  thread_local std::vector<bool> seen;  // none of them between calls: what is looked at is not all of a large tape
  if (seen.size() < nth(tape.size())) seen.resize(nth(tape.size()), false);
  std::vector<Index> parts{whole};
  seen[nth(whole)] = true;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const Node& node = tape[parts[k]];
    for (const Index part : {node.a, node.b, node.c})
      if (part != none && !seen[nth(part)]) {
        seen[nth(part)] = true;
        parts.push_back(part);
      }
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
    for (const Index part : {node.a, node.b, node.c})
      if (part != none) of |= of_[nth(part)];
    of_.push_back(of);
  }
  return of_[nth(y.place())];
}

std::vector<Symbol> gradient(Tape& tape, const Symbol& y, std::span<const int> variables) {
  std::vector<Symbol> slopes(variables.size());
  walk_back(tape, y, parts_of(tape, y), [&](int number, const Symbol& slope) {
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
  walk_back(tape, y, parts, [&](int number, const Symbol& slope) {
    const auto place = static_cast<std::size_t>(number - first);
    if (number >= first && place < count && !is_zero(slope)) slopes.emplace_back(place, slope);
  });
  std::ranges::sort(slopes, {}, &std::pair<std::size_t, Symbol>::first);
  return slopes;
}

Symbol Substitution::operator()(const Symbol& y) {
  if (y.is_constant()) return y;
  const Index last = y.place();
  if (made_.size() <= nth(last)) {
    made_.resize(nth(from_.size()));
    known_.resize(made_.size(), false);
  }
  if (known_[nth(last)]) return made_[nth(last)];
  for (const Index i : parts_of(from_, last)) {
    if (known_[nth(i)]) continue;
    known_[nth(i)] = true;
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
        made = raise(a(), b());
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
    }
  }
  return made_[nth(last)];
}

}  // namespace least::tape
