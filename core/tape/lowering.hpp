// Lowering makes the steps of a program from the nodes of a tape (core/tape/lowered.hpp).
#pragma once

#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/tape/lane_table.hpp"

namespace least::tape {

/// Form is a node as a constant plus values and products with factors, in the lists of the program.
struct Form {
  double constant = 0;
  Index first_value = 0, values = 0, first_product = 0, products = 0;

  constexpr Index terms() const { return values + products; }
};

/// The work per node is bounded: known values are looked up by row or lane, and a sum becomes a value of its own before
/// it is long.
class Lowering {
 public:
  constexpr Lowering(const Tape& tape, Program& program)
      : tape_(tape),
        program_(program),
        forms_(size(tape.size())),
        lowered_(size(tape.size()), false),
        kept_(size(tape.size()), none),
        rows_(size(program.rows)),
        uses_(size(tape.size()), 0) {
    rows_.reserve(4 * size(tape.size()));
  }

  /// Makes steps for the nodes `roots` and all that they need; the values of the roots become rates.
  constexpr void lower(std::span<const Index> roots) {
    std::vector<bool> wanted(size(tape_.size()), false);
    for (const Index root : roots) wanted[size(root)] = true;
    for (Index i = tape_.size(); i-- > 0;)
      if (wanted[size(i)])
        for (const Index part : {tape_[i].a, tape_[i].b, tape_[i].c})
          if (part != none) {
            wanted[size(part)] = true;
            if (!lowered_[size(part)]) ++uses_[size(part)];  // what has been lowered stays as it is
          }
    // In the order of need: compilers evaluate operands, and so write tapes, in different orders.
    std::vector<Index> path;
    path.reserve(size(tape_.size()));
    for (const Index root : roots)
      for (path.push_back(root); !path.empty();) {
        const Index i = path.back();
        const Index part = lowered_[size(i)] ? none : missing_part(i);
        if (part != none) {
          path.push_back(part);
          continue;
        }
        path.pop_back();
        if (lowered_[size(i)]) continue;
        forms_[size(i)] = form_of(i);
        lowered_[size(i)] = true;
        const Index terms = forms_[size(i)].terms();
        if ((uses_[size(i)] > 1 && terms > 1) || terms > most_terms) keep(i);
      }
    for (const Index root : roots) program_.rate.push_back(keep(root));
  }

 private:
  static constexpr Index most_terms = 40;  ///< of a sum that is still copied into the sums that use it
  /// What is known of a value: the value that holds k times its coefficients; the step that computes it, in `linear` or
  /// in `steps`; the place where it was last put as a term of a sum; the last function pair of which it is the
  /// argument.
  struct Row {
    Index weighted = none, step = none, term = none, pair = none;
    bool linear = false;
  };
  /// What is known of a lane: the place where it was last put as a term of a sum; the value that is this product alone.
  struct Lane {
    Index term = none, step = none;
  };

  static constexpr std::size_t size(Index i) { return static_cast<std::size_t>(i); }
  constexpr Form& form(Index node) { return forms_[size(node)]; }

  /// Returns an operand of the node that is not lowered yet, or none.
  constexpr Index missing_part(Index i) const {
    for (const Index part : {tape_[i].a, tape_[i].b, tape_[i].c})
      if (part != none && !lowered_[size(part)]) return part;
    return none;
  }

  constexpr Index new_value() {
    rows_.push_back({});
    return program_.rows++;
  }
  constexpr Row& row(Index value) { return rows_[size(value)]; }
  /// Returns the value that holds k times the coefficients of a value, which is made when first needed.
  constexpr Index weighted(Index value) {
    if (row(value).weighted != none) return row(value).weighted;
    const Index made = new_value();
    row(value).weighted = made;
    if (value >= Program::first_variable && value <= program_.time())
      program_.weighted[size(value - Program::first_variable)] = made;
    else if (row(value).step != none)
      (row(value).linear ? program_.linear : program_.steps)[size(row(value).step)].weighted = made;
    return made;
  }
  constexpr Index lane(Index a, Index b) {
    lanes_known_.resize(program_.lane_a.size() + 1);
    return lanes_.of(a, b, program_);
  }
  constexpr Index finish(Step step) {
    if (step.out == none) step.out = new_value();
    step.weighted = Program::waste;
    row(step.out).step = static_cast<Index>(program_.steps.size());
    program_.steps.push_back(step);
    if (step.rule == Rule::sum && step.values == 0 && step.products == 1 && step.c == 0) {
      const Program::Product& product = program_.products[size(step.first_product)];
      Index& known = lanes_known_[size(product.lane)].step;
      if (product.factor == 1 && known == none) known = step.out;
    }
    return step.out;
  }
  constexpr bool is_linear(Index value) { return value == program_.time() || row(value).linear; }

  constexpr Form of_value(Index value, double factor = 1) {
    Form made{0, static_cast<Index>(program_.values.size()), 1, 0, 0};
    program_.values.push_back({value, factor});
    return made;
  }
  constexpr Form of_product(Index a, Index b, double factor) {
    Form made{0, 0, 0, static_cast<Index>(program_.products.size()), 1};
    program_.products.push_back({a, b, lane(a, b), factor});
    return made;
  }
  /// Puts a term into the last `count` of a list, from `first` on; `known` is where an equal term was put last.
  template <class Term>
  static constexpr void put(std::vector<Term>& list, const Term& term, Index Term::*what, Index& known, Index first,
                            Index& count) {
    if (known >= first && known < first + count && list[size(known)].*what == term.*what) {
      list[size(known)].factor += term.factor;
    } else {
      known = first + count++;
      list.push_back(term);
    }
  }
  /// x f + y g; terms alike are put together.
  constexpr Form combine(double x, const Form& f, double y, const Form& g) {
    Form made{x * f.constant + y * g.constant, static_cast<Index>(program_.values.size()), 0,
              static_cast<Index>(program_.products.size()), 0};
    for (const auto& [factor, part] : {std::pair{x, &f}, std::pair{y, &g}}) {
      for (Index i = 0; i < part->values; ++i) {
        Program::Value term = program_.values[size(part->first_value + i)];
        term.factor *= factor;
        put(program_.values, term, &Program::Value::value, row(term.value).term, made.first_value, made.values);
      }
      for (Index i = 0; i < part->products; ++i) {
        Program::Product term = program_.products[size(part->first_product + i)];
        term.factor *= factor;
        Index& known = lanes_known_[size(term.lane)].term;
        put(program_.products, term, &Program::Product::lane, known, made.first_product, made.products);
      }
    }
    return made;
  }

  /// Returns the value of a node, for which a step is made when it is first needed.
  constexpr Index keep(Index node) {
    Index& value = kept_[size(node)];
    if (value == none) {
      const Form f = form(node);
      if (f.constant == 0 && f.values == 1 && f.products == 0 && program_.values[size(f.first_value)].factor == 1) {
        value = program_.values[size(f.first_value)].value;
      } else {
        value = finish({.rule = Rule::sum,
                        .first_value = f.first_value,
                        .values = f.values,
                        .first_product = f.first_product,
                        .products = f.products,
                        .c = f.constant});
        if (tape_[node].linear) {
          row(value).linear = true;
          row(value).step = static_cast<Index>(program_.linear.size());
          program_.linear.push_back(program_.steps.back());
          program_.steps.pop_back();
        }
        form(node) = of_value(value);
      }
    }
    return value;
  }
  /// Returns a node as a value and a factor.
  constexpr std::pair<Index, double> scaled(Index node) {
    const Form f = form(node);
    if (f.constant == 0 && f.values == 1 && f.products == 0) {
      const auto [value, factor] = program_.values[size(f.first_value)];
      return {value, factor};
    }
    if (f.constant == 0 && f.values == 0 && f.products == 1) {
      const Program::Product product = program_.products[size(f.first_product)];
      if (const Index kept = lanes_known_[size(product.lane)].step; kept != none) return {kept, product.factor};
      Step step{
          .rule = Rule::sum, .first_product = static_cast<Index>(program_.products.size()), .products = 1, .c = 0};
      program_.products.push_back({product.a, product.b, product.lane, 1});
      return {finish(step), product.factor};
    }
    return {keep(node), 1};
  }

  constexpr Form product(Index a, Index b) {
    for (const auto& [c, other] : {std::pair{a, b}, std::pair{b, a}})
      if (form(c).terms() == 0) {
        const double factor = form(c).constant;
        return combine(factor, form(other), 0, Form{});
      }
    auto [x, c] = scaled(a);
    auto [y, d] = scaled(b);
    if (!is_linear(x)) std::swap(x, y);
    if (is_linear(x)) return of_value(finish({.rule = Rule::linear_product, .a = x, .w = y}), c * d);
    program_.whole = false;
    return of_product(x, y, c * d);
  }
  constexpr Form quotient(Index a, Index b) {
    program_.whole = false;
    const auto [below, d] = scaled(b);
    Step step{.rule = is_linear(below) ? Rule::linear_quotient : Rule::quotient, .b = below};
    if (is_linear(below)) program_.poles.push_back(below);
    double factor = 1 / d;
    if (form(a).terms() == 0) {
      step.a = none;
      factor *= form(a).constant;
    } else {
      const auto [above, c] = scaled(a);
      step.a = above;
      factor *= c;
    }
    step.out = new_value();
    if (step.rule == Rule::quotient) step.lane = lane(below, step.out);
    return of_value(finish(step), factor);
  }
  /// (c x)ᵖ = cᵖ xᵖ for c > 0.
  constexpr Form power(Index a, double p, bool root) {
    program_.whole = false;
    program_.partial = true;
    auto [base, c] = scaled(a);
    if (!(c > 0)) base = keep(a), c = 1;
    Step step{.rule = root ? Rule::root : Rule::power, .a = base, .p = p};
    const Index out = step.out = new_value();
    if (is_linear(base)) {
      step.rule = Rule::linear_power;
      program_.poles.push_back(base);
    } else if (root) {
      step.lane = lane(out, out);
    } else {
      step.b = weighted(base);
      const Index slope = new_value();
      row(out).weighted = slope;
      step.lane = lane(step.b, out);
      step.w = lane(base, slope);
      finish(step);
      program_.steps.back().weighted = slope;
      return of_value(out, std::pow(c, p));
    }
    return of_value(finish(step), std::pow(c, p));
  }

  /// f(p a) by ȯut = c w ȧ.
  constexpr void integral(Op f, Index out, Index a, double p, Index w, double c) {
    Step step{.rule = Rule::integral, .function = f, .out = out, .a = a, .w = w, .c = c * p, .p = p};
    if (a == program_.time() || is_linear(a)) {
      step.rule = Rule::linear_integral;
    } else {
      program_.whole = false;
      step.b = weighted(a);
      step.lane = lane(step.b, w);
    }
    finish(step);
  }
  /// sin and cos, or sinh and cosh: each is the derivative of the other, but for a sign.
  constexpr Form pair(Op asked, Op odd, Op even, double sign, Index node) {
    const auto [a, p] = scaled(node);
    for (Index i = row(a).pair; i != none; i = pairs_[size(i)].before) {
      const Pair& known = pairs_[size(i)];
      if (known.odd == odd && known.p == p) return of_value(asked == odd ? known.first : known.second);
    }
    const Index first = new_value(), second = new_value();
    integral(odd, first, a, p, second, 1);
    integral(even, second, a, p, first, sign);
    pairs_.push_back({odd, row(a).pair, p, first, second});
    row(a).pair = static_cast<Index>(pairs_.size()) - 1;
    return of_value(asked == odd ? first : second);
  }
  /// exp, tan and tanh, whose derivative w is out (`sign` 0) or 1 ± out² (`sign` ±1).
  constexpr Form self(Op f, Index node, double sign) {
    const auto [a, p] = scaled(node);
    const Index out = new_value(), w = sign == 0 ? out : new_value();
    integral(f, out, a, p, w, 1);
    if (sign != 0) {
      program_.whole = false;
      const Form square = of_product(out, out, sign);
      finish({.rule = Rule::sum, .out = w, .first_product = square.first_product, .products = 1, .c = 1});
    }
    return of_value(out);
  }
  /// ln a, atan a, asin a, acos a: ȯut = c ȧ/w, with w = a, 1 + a², √(1 − a²).
  constexpr Form log_like(Op f, Index node) {
    program_.whole = false;
    program_.partial = true;
    const Index a = keep(node);
    Index w = a;
    if (f != Op::log) {
      const Form square = of_product(a, a, f == Op::atan ? 1 : -1);
      w = finish({.rule = Rule::sum, .first_product = square.first_product, .products = 1, .c = 1});
      if (const Index root = f == Op::atan ? none : new_value(); root != none)
        w = finish({.rule = Rule::root, .out = root, .a = w, .lane = lane(root, root)});
    }
    const Index rate = weighted(a), out = new_value(), slope = new_value();
    row(out).weighted = slope;
    finish({.rule = Rule::log_like,
            .function = f,
            .out = out,
            .a = a,
            .b = rate,
            .w = w,
            .lane = lane(w, slope),
            .c = f == Op::acos ? -1.0 : 1.0});
    program_.steps.back().weighted = slope;
    return of_value(out);
  }

  constexpr Form form_of(Index i) {
    const Node& node = tape_[i];
    switch (node.op) {
      case Op::constant:
        return {.constant = node.value};
      case Op::time:
        return of_value(program_.time());
      case Op::variable:
        return of_value(Program::first_variable + static_cast<Index>(node.value));
      case Op::add:
        return combine(1, form(node.a), 1, form(node.b));
      case Op::subtract:
        return combine(1, form(node.a), -1, form(node.b));
      case Op::multiply:
        return product(node.a, node.b);
      case Op::divide:
        return quotient(node.a, node.b);
      case Op::power:
        return power(node.a, node.value, false);
      case Op::sqrt:
        return power(node.a, 0.5, true);
      case Op::exp:
        return self(node.op, node.a, 0);
      case Op::tan:
        return self(node.op, node.a, 1);
      case Op::tanh:
        return self(node.op, node.a, -1);
      case Op::sin:
      case Op::cos:
        return pair(node.op, Op::sin, Op::cos, -1, node.a);
      case Op::sinh:
      case Op::cosh:
        return pair(node.op, Op::sinh, Op::cosh, 1, node.a);
      case Op::log:
      case Op::atan:
      case Op::asin:
      case Op::acos:
        return log_like(node.op, node.a);
      case Op::total:  // its terms have to be written out before
        throw TooManyOperations();
      case Op::raise:
        throw std::logic_error("a power whose exponent moves has to be written as an exponential before");
      case Op::select:
        break;
    }
    program_.whole = false;
    const Index difference = keep(node.a);
    program_.switches.push_back(difference);
    return of_value(finish({.rule = Rule::select, .a = keep(node.b), .b = keep(node.c), .w = difference}));
  }

  struct Pair {
    Op odd;
    Index before;  ///< the pair before, of the same argument
    double p;
    Index first, second;
  };

  const Tape& tape_;
  Program& program_;
  std::vector<Form> forms_;
  std::vector<bool> lowered_;
  std::vector<Index> kept_;
  std::vector<Row> rows_;
  std::vector<int> uses_;
  LaneTable lanes_;
  std::vector<Lane> lanes_known_;
  std::vector<Pair> pairs_;
};

}  // namespace least::tape
