#include "core/tape/shared_products.hpp"

#include <utility>

#include "core/tape/series_rules.hpp"

namespace least::tape {
namespace {

/// Rewrites the lists of a program, step by step. Steps linear in time have no products.
class ProductSharing {
 public:
  explicit ProductSharing(Program& program)
      : p_(program), uses_(program.lane_a.size(), 0), value_of_(program.lane_a.size(), none) {
    for (std::size_t i = 0; i < p_.motion_steps; ++i)
      if (const Step& s = p_.steps[i]; s.rule == Rule::sum)
        for (Index k = 0; k < s.products; ++k) ++uses_[at(product(s, k).lane)];
  }

  void share() {
    for (const Step& s : p_.linear) write(s);
    p_.linear = std::exchange(steps_, {});
    std::size_t motion_steps = 0;
    for (std::size_t i = 0; i < p_.steps.size(); ++i) {
      write(p_.steps[i]);
      if (i + 1 == p_.motion_steps) motion_steps = steps_.size();
    }
    p_.motion_steps = motion_steps;
    p_.steps = std::move(steps_);
    p_.values = std::move(values_);
    p_.products = std::move(products_);
  }

 private:
  const Program::Product& product(const Step& s, Index i) const { return p_.products[at(s.first_product + i)]; }

  void write(Step s) {
    const bool sum = s.rule == Rule::sum, alone = sum && s.products == 1 && s.values == 0 && s.c == 0;
    const auto own = p_.values.begin() + s.first_value;
    std::vector<Program::Value> values(own, own + s.values);
    std::vector<Program::Product> products;
    for (Index i = 0; i < s.products; ++i) {
      const Program::Product& term = product(s, i);
      if (sum && !alone && uses_[at(term.lane)] > 1) {
        values.push_back({value_of(term), term.factor});
      } else {
        products.push_back(term);
      }
    }
    if (alone && products.front().factor == 1 && value_of_[at(products.front().lane)] == none)
      value_of_[at(products.front().lane)] = s.out;
    append(s, values, products);
  }
  /// Returns the value that equals a product; its step is written when it is first needed.
  Index value_of(const Program::Product& term) {
    Index& value = value_of_[at(term.lane)];
    if (value == none) {
      value = p_.rows++;
      const Program::Product alone{term.a, term.b, term.lane, 1};
      append({.rule = Rule::sum, .out = value, .weighted = Program::waste, .c = 0}, {}, std::span(&alone, 1));
    }
    return value;
  }
  void append(Step s, std::span<const Program::Value> values, std::span<const Program::Product> products) {
    s.first_value = static_cast<Index>(values_.size());
    s.values = static_cast<Index>(values.size());
    s.first_product = static_cast<Index>(products_.size());
    s.products = static_cast<Index>(products.size());
    values_.insert(values_.end(), values.begin(), values.end());
    products_.insert(products_.end(), products.begin(), products.end());
    steps_.push_back(s);
  }

  Program& p_;
  std::vector<int> uses_;        ///< by lane: uses in sums of the motion, on which other steps must have no effect
  std::vector<Index> value_of_;  ///< by lane
  std::vector<Step> steps_;
  std::vector<Program::Value> values_;
  std::vector<Program::Product> products_;
};

}  // namespace

void share_products(Program& program) { ProductSharing(program).share(); }

}  // namespace least::tape
