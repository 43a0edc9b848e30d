#include "core/tape/formula.hpp"

#include <cmath>
#include <limits>

namespace least::tape {

/// Writes steps whose registers are all different, then gives them as few as they need at once.
class Formula::Compiler {
 public:
  Compiler(const Tape& tape, Formula& formula) : tape_(tape), formula_(formula), place_(at(tape.size()), none) {}

  void compile(std::span<const Index> outputs) {
    std::vector<bool> needed(at(tape_.size()), false);
    for (const Index i : outputs) needed[at(i)] = true;
    for (Index i = tape_.size(); i-- > 0;)
      if (needed[at(i)])
        for (const Index part : {tape_[i].a, tape_[i].b, tape_[i].c})
          if (part != none) needed[at(part)] = true;
    for (Index i = 0; i < tape_.size(); ++i)
      if (needed[at(i)] && tape_[i].op != Op::constant) place_[at(i)] = translate(tape_[i]);
    std::vector<Index> ends;
    for (const Index i : outputs) ends.push_back(registered(i));
    assign(ends);
    formula_.batches_ = Batches::of(wide_, ends);
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  bool fixed(Index i) const { return tape_[i].op == Op::constant; }

  Index emit(Operation step) {
    wide_.push_back(step);
    return static_cast<Index>(wide_.size()) - 1;
  }
  /// Where the value of a node stands; of a constant only now.
  Index registered(Index i) {
    if (place_[at(i)] == none) place_[at(i)] = emit({.code = Code::constant, .value = tape_[i].value});
    return place_[at(i)];
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
      case Op::constant:
        break;
    }
    return none;
  }

  /// Small whole and half exponents are products and a root: exact where pow is, and ten times faster.
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

  void assign(const std::vector<Index>& ends) {
    constexpr Index forever = 1 << 30;
    std::vector<Index> last(wide_.size(), none);
    for (Index i = 0; i < static_cast<Index>(wide_.size()); ++i) {
      const Operation& step = wide_[at(i)];
      if (step.code == Code::variable) continue;
      for (const Index part : {step.a, step.b, step.c})
        if (part != none) last[at(part)] = i;
    }
    for (const Index end : ends) last[at(end)] = forever;
    std::vector<Register> given(wide_.size()), free;
    for (Index i = 0; i < static_cast<Index>(wide_.size()); ++i) {
      const Operation& step = wide_[at(i)];
      const auto place = [&](Index part) { return part == none ? Register(0) : given[at(part)]; };
      Narrow narrow{step.code,     0,         place(step.code == Code::variable ? none : step.a), place(step.b),
                    place(step.c), step.value};
      if (step.code == Code::variable) narrow.a = static_cast<Register>(step.a);
      if (step.code != Code::variable)
        for (const Index part : {step.a, step.b, step.c})
          if (part != none && last[at(part)] == i) {
            free.push_back(given[at(part)]);
            last[at(part)] = none;  // once, where it is named twice
          }
      if (last[at(i)] == none) last[at(i)] = i;
      if (free.empty()) {
        if (formula_.registers_ > std::numeric_limits<Register>::max()) throw TooManyOperations();
        free.push_back(static_cast<Register>(formula_.registers_++));
      }
      narrow.out = given[at(i)] = free.back();
      free.pop_back();
      formula_.steps_.push_back(narrow);
    }
    for (const Index end : ends) formula_.outputs_.push_back(given[at(end)]);
  }

  const Tape& tape_;
  Formula& formula_;
  std::vector<Index> place_;
  std::vector<Operation> wide_;
};

Formula::Formula(const Tape& tape, std::span<const Index> outputs) { Compiler(tape, *this).compile(outputs); }

}  // namespace least::tape
