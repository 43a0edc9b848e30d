#include "core/tape/translation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace least::tape {
namespace {

class Translator {
 public:
  explicit Translator(const Tape& tape) : tape_(tape) { made_.place.assign(at(tape.size()), none); }

  Translation translate(std::span<const Index> outputs) {
    std::vector<bool> needed(at(tape_.size()), false);
    for (const Index i : outputs) needed[at(i)] = true;
    for (Index i = tape_.size(); i-- > 0;) {
      if (!needed[at(i)]) continue;
      if (tape_[i].op == Op::total) {
        for (const Index operand : operands_of(static_cast<Index>(tape_[i].low))) needed[at(operand)] = true;
      } else {
        tape_.for_each_operand(tape_[i], [&](Index part) { needed[at(part)] = true; });
      }
    }
    for (Index i = 0; i < tape_.size(); ++i)
      if (needed[at(i)] && tape_[i].op != Op::constant) made_.place[at(i)] = translate(tape_[i]);
    for (const Index i : outputs) made_.ends.push_back(registered(i));
    return std::move(made_);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  bool fixed(Index i) const { return tape_[i].op == Op::constant; }

  /// Returns the operands of terms that have to be computed before: those of arguments that are neither constants nor
  /// variables.
  const std::vector<Index>& operands_of(Index number) {
    const auto [operands, is_new] = operands_.try_emplace(number);
    if (!is_new) return operands->second;
    const Terms& terms = tape_.terms(number);
    for (Index k = 0; k < terms.arguments; ++k) {
      if (is_all(tape_, terms, k, Op::constant) || is_all(tape_, terms, k, Op::variable)) continue;
      const auto first = terms.given.begin() + static_cast<std::ptrdiff_t>(k) * terms.count;
      operands->second.insert(operands->second.end(), first, first + terms.count);
    }
    std::vector<Index>& all = operands->second;
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  Index emit(Operation step) {
    made_.steps.push_back(step);
    return static_cast<Index>(made_.steps.size()) - 1;
  }
  /// Returns the step of a node; the step of a constant is written when it is first needed.
  Index registered(Index i) {
    Index& place = made_.place[at(i)];
    if (place == none) place = emit({.code = Code::constant, .value = tape_[i].value});
    return place;
  }

  Index translate(const Node& node) {
    const auto unary = [&](Code code) { return emit({.code = code, .a = registered(node.a)}); };
    const auto binary = [&](Code code) {
      return emit({.code = code, .a = registered(node.a), .b = registered(node.b)});
    };
    const auto with = [&](Code code, Index a, double value) {
      return emit({.code = code, .a = registered(a), .value = value});
    };
    switch (node.op) {
      case Op::time:
        return emit({.code = Code::time});
      case Op::variable:
        return emit({.code = Code::variable, .a = static_cast<Index>(node.value)});
      case Op::add:
        if (fixed(node.a)) return with(Code::add_constant, node.b, tape_[node.a].value);
        if (fixed(node.b)) return with(Code::add_constant, node.a, tape_[node.b].value);
        return binary(Code::add);
      case Op::subtract:
        if (fixed(node.a)) return with(Code::from_constant, node.b, tape_[node.a].value);
        if (fixed(node.b)) return with(Code::add_constant, node.a, -tape_[node.b].value);
        return binary(Code::subtract);
      case Op::multiply:
        if (fixed(node.a)) return with(Code::scale, node.b, tape_[node.a].value);
        if (fixed(node.b)) return with(Code::scale, node.a, tape_[node.b].value);
        return binary(Code::multiply);
      case Op::divide:
        if (fixed(node.a)) return with(Code::over, node.b, tape_[node.a].value);
        return binary(Code::divide);
      case Op::power:
        return power(registered(node.a), node.value);
      case Op::raise:
        return emit({.code = Code::exp,
                     .a = emit({.code = Code::multiply,
                                .a = registered(node.b),
                                .b = emit({.code = Code::log, .a = registered(node.a)})})});
      case Op::sqrt:
        return unary(Code::sqrt);
      case Op::exp:
        return unary(Code::exp);
      case Op::log:
        return unary(Code::log);
      case Op::sin:
        return unary(Code::sin);
      case Op::cos:
        return unary(Code::cos);
      case Op::tan:
        return unary(Code::tan);
      case Op::sinh:
        return unary(Code::sinh);
      case Op::cosh:
        return unary(Code::cosh);
      case Op::tanh:
        return unary(Code::tanh);
      case Op::atan:
        return unary(Code::atan);
      case Op::asin:
        return unary(Code::asin);
      case Op::acos:
        return unary(Code::acos);
      case Op::select:
        return emit({.code = Code::select, .a = registered(node.a), .b = registered(node.b), .c = registered(node.c)});
      case Op::total:
        return emit({.code = Code::total, .a = added_up(static_cast<Index>(node.low)), .value = node.value});
      case Op::constant:
        break;
    }
    return none;
  }

  /// Returns the step that adds up terms; it is written after the steps that these read.
  Index added_up(Index terms) {
    const auto [place, is_new] = added_up_.try_emplace(terms, none);
    if (!is_new) return place->second;
    for (const Index operand : operands_of(terms)) registered(operand);
    return added_up_[terms] = emit({.code = Code::add_up, .value = static_cast<double>(terms)});
  }

  /// Small whole and half exponents become products and a root, which are ten times faster than pow, and exact where it
  /// is.
  Index power(Index a, double exponent) {
    const double halves = std::abs(2 * exponent);
    if (!(halves <= 32 && halves == std::floor(halves))) return emit({.code = Code::power, .a = a, .value = exponent});
    Index result = none, square = a;
    if (std::fmod(halves, 2) != 0) result = emit({.code = Code::sqrt, .a = a});
    const auto times = [&](Index x, Index y) { return emit({.code = Code::multiply, .a = x, .b = y}); };
    for (int n = static_cast<int>(halves) / 2; n > 0; n /= 2) {
      if (n % 2) result = result == none ? square : times(square, result);
      if (n > 1) square = times(square, square);
    }
    return exponent < 0 ? emit({.code = Code::over, .a = result, .value = 1}) : result;
  }

  const Tape& tape_;
  Translation made_;
  std::map<Index, std::vector<Index>> operands_;  ///< of terms
  std::map<Index, Index> added_up_;               ///< terms
};

}  // namespace

bool is_all(const Tape& tape, const Terms& terms, Index argument, Op op) {
  const auto first = terms.given.begin() + static_cast<std::ptrdiff_t>(argument) * terms.count;
  return std::all_of(first, first + terms.count, [&](Index i) { return tape[i].op == op; });
}

Translation translated(const Tape& tape, std::span<const Index> outputs) { return Translator(tape).translate(outputs); }

}  // namespace least::tape
