#include "core/tape/fused_steps.hpp"

#include <utility>

#include "core/tape/long_sums.hpp"
#include "core/tape/terms.hpp"

namespace least::tape {
namespace {

class Fuser {
 public:
  explicit Fuser(const Translation& from) : from_(from), readers_(from.steps.size(), 0) {
    for (const Operation& step : from.steps) for_each_operand(step, [&](Index part) { ++readers_[nth(part)]; });
    for (const Index end : from.ends) ++readers_[nth(end)];
    made_.reserve(from.steps.size());
    for (const Operation& step : from.steps) made_.push_back({step});
  }

  std::vector<FusedStep> fuse() {
    for (Index i = 0; i < static_cast<Index>(made_.size()); ++i) {
      const Operation& step = from_.steps[nth(i)];
      if (step.code == Code::over) fuse_power(i, step);
      if (step.code == Code::add) fuse_squares(i, step);
      if (step.code == Code::add_constant) add_to_squares(i, step);
    }
    return std::move(made_);
  }

 private:
  const Operation& step(Index i) const { return from_.steps[nth(i)]; }
  /// Whether a step has this code, is not fused, and is read by one other step only.
  bool is_inner(Index i, Code code) const {
    return step(i).code == code && readers_[nth(i)] == 1 && made_[nth(i)].fused == Fused::nothing;
  }
  bool is_inner_square(Index i) const { return is_inner(i, Code::multiply) && step(i).a == step(i).b; }
  void absorb(Index i) { made_[nth(i)].absorbed = true; }

  void fuse_power(Index i, const Operation& over) {
    if (!is_inner(over.a, Code::multiply)) return;
    const Operation& product = step(over.a);
    for (const auto& [x, root] : {std::pair(product.a, product.b), std::pair(product.b, product.a)}) {
      if (!is_inner(root, Code::sqrt) || step(root).a != x) continue;
      absorb(over.a);
      absorb(root);
      made_[nth(i)] = {{.code = over.code, .a = x, .value = over.value}, Fused::over_three_halves};
      return;
    }
  }

  void fuse_squares(Index i, const Operation& sum) {
    if (!is_inner_square(sum.b)) return;
    const Index last = step(sum.b).a;
    const FusedStep& before = made_[nth(sum.a)];
    const bool goes_on = readers_[nth(sum.a)] == 1 && before.fused == Fused::two_squares && before.operation.value == 0;
    if (goes_on) {
      absorb(sum.a);
      made_[nth(i)] = {{.code = sum.code, .a = before.operation.a, .b = before.operation.b, .c = last},
                       Fused::three_squares};
    } else if (is_inner_square(sum.a)) {
      absorb(sum.a);
      made_[nth(i)] = {{.code = sum.code, .a = step(sum.a).a, .b = last}, Fused::two_squares};
    } else {
      return;
    }
    absorb(sum.b);
  }

  void add_to_squares(Index i, const Operation& sum) {
    const FusedStep& before = made_[nth(sum.a)];
    const bool squares = before.fused == Fused::two_squares || before.fused == Fused::three_squares;
    if (!squares || readers_[nth(sum.a)] != 1) return;
    absorb(sum.a);
    made_[nth(i)] = {before.operation, before.fused};
    made_[nth(i)].operation.value = sum.value;
  }

  const Translation& from_;
  std::vector<int> readers_;
  std::vector<FusedStep> made_;
};

}  // namespace

std::vector<FusedStep> fused(const Translation& from) { return Fuser(from).fuse(); }

}  // namespace least::tape
