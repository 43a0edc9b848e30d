#include "core/tape/step_batches.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>

#include "core/tape/series_rules.hpp"
#include "core/tape/shared_products.hpp"

namespace least::tape {
namespace {

constexpr std::size_t fewest_alike = 4;       // with fewer, steps are computed one by one
constexpr std::size_t most_of_unrolled = 64;  // steps: such programs keep the bits of the unrolled series

std::size_t filled_up(std::size_t count) {
  return (count + StepBatches::width - 1) / StepBatches::width * StepBatches::width;
}

/// Whether a step of the rule needs the value a, b or w of the order that it computes.
constexpr bool reads_a(Rule rule) { return rule != Rule::sum; }
constexpr bool reads_b(Rule rule) {
  return rule == Rule::quotient || rule == Rule::linear_quotient || rule == Rule::select;
}
constexpr bool reads_w(Rule rule) { return rule == Rule::select || rule == Rule::linear_product; }
/// Whether a step of the rule has a value b or w at all, of which it may need lower orders only.
constexpr bool has_b(Rule rule) {
  return reads_b(rule) || rule == Rule::power || rule == Rule::integral || rule == Rule::log_like;
}
constexpr bool has_w(Rule rule) {
  return reads_w(rule) || rule == Rule::integral || rule == Rule::linear_integral || rule == Rule::log_like;
}
/// Whether its recurrence contains a product of two series.
constexpr bool has_lane(Rule rule) {
  return rule == Rule::quotient || rule == Rule::root || rule == Rule::power || rule == Rule::integral ||
         rule == Rule::log_like;
}

/// Calls f with each value of which a step reads the order that it computes.
template <class F>
void for_each_read(const Program& p, const Step& s, F&& f) {
  if (reads_a(s.rule) && s.a != none) f(s.a);
  if (reads_b(s.rule)) f(s.b);
  if (reads_w(s.rule)) f(s.w);
  for (Index i = 0; i < s.values; ++i) f(p.values[at(s.first_value + i)].value);
  for (Index i = 0; i < s.products; ++i) f(p.products[at(s.first_product + i)].a);
  for (Index i = 0; i < s.products; ++i) f(p.products[at(s.first_product + i)].b);
}

}  // namespace

/// Groups steps of the same rule, numbers of operands and depth (the longest chain of dependences within an order), and
/// renumbers steps, values and lanes.
class StepBatches::Arrangement {
 public:
  Arrangement(Program& program, StepBatches& made) : p_(program), made_(made) {
    group();
    order();
    number_values();
    number_lanes();
    write_batches();
  }

 private:
  struct Kind {
    bool beyond_motion;
    Index depth;
    Rule rule;
    Op function;
    Index values, products;
    bool has_a, has_weighted;
    std::uint64_t squares;  ///< bits of the products that are squares

    auto key() const {
      return std::tie(beyond_motion, depth, rule, function, values, products, has_a, has_weighted, squares);
    }
    bool operator<(const Kind& other) const { return key() < other.key(); }
  };
  static constexpr Index most_products_with_squares = 64;

  Kind kind_of(std::size_t i, Index depth) const {
    const Step& s = p_.steps[i];
    std::uint64_t squares = 0;
    for (Index k = 0; k < s.products; ++k) {
      const Program::Product& term = p_.products[at(s.first_product + k)];
      if (term.a == term.b) squares |= std::uint64_t{1} << (k % most_products_with_squares);
    }
    return {
        i >= p_.motion_steps,         depth,  s.rule, s.function, s.values, s.products, reads_a(s.rule) && s.a != none,
        s.weighted != Program::waste, squares};
  }
  /// Whether steps of a kind may form a batch. Rare rules are not worth it. Squares have another formula than products
  /// of two, so they have to be at the same places in all steps, which `squares` can tell for 64 products.
  static bool can_be_batched(const Kind& kind) {
    const bool often = kind.rule == Rule::sum || has_lane(kind.rule);
    return often && (kind.squares == 0 || kind.products <= most_products_with_squares);
  }

  /// Groups the steps by kind, each group in the order of the program.
  void group() {
    std::vector<Index> depth(at(p_.rows), 0);
    std::map<Kind, std::vector<std::size_t>> all;
    for (std::size_t i = 0; i < p_.steps.size(); ++i) {
      const Step& s = p_.steps[i];
      Index last = 0;
      for_each_read(p_, s, [&](Index value) { last = std::max(last, depth[at(value)]); });
      depth[at(s.out)] = last + 1;
      if (s.weighted != Program::waste) depth[at(s.weighted)] = last + 1;
      all[kind_of(i, last + 1)].push_back(i);
    }
    group_of_.assign(p_.steps.size(), 0);
    for (auto& [kind, steps] : all) {
      const bool alike = steps.size() >= fewest_alike && can_be_batched(kind);
      for (const std::size_t i : steps) group_of_[i] = groups_.size();
      groups_.push_back({kind, alike, std::move(steps)});
    }
  }

  /// Orders the steps within groups so that operands are mostly consecutive. Groups whose steps read little are ordered
  /// first, and the steps that compute their operands take over their order.
  void order() {
    std::vector<std::size_t> maker(at(p_.rows), p_.steps.size());
    for (std::size_t i = 0; i < p_.steps.size(); ++i) maker[at(p_.steps[i].out)] = i;
    std::vector<std::size_t> sequence;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (groups_[g].alike) sequence.push_back(g);
    std::ranges::sort(sequence, {}, [&](std::size_t g) {
      const Kind& kind = groups_[g].kind;
      return std::tuple(kind.values + 2 * kind.products + (kind.has_a ? 1 : 0), -kind.depth,
                        -static_cast<std::ptrdiff_t>(groups_[g].steps.size()), g);
    });
    std::vector<bool> placed(p_.steps.size(), false), done(groups_.size(), false);
    std::vector<std::vector<std::size_t>> ordered(groups_.size());
    for (const std::size_t g : sequence) {
      for (const std::size_t i : groups_[g].steps)
        if (!placed[i]) ordered[g].push_back(i);
      groups_[g].steps = ordered[g];
      done[g] = true;
      std::vector<std::vector<Index>> reads(ordered[g].size());
      for (std::size_t k = 0; k < reads.size(); ++k)
        for_each_read(p_, p_.steps[ordered[g][k]], [&](Index value) { reads[k].push_back(value); });
      for (std::size_t slot = 0; slot < reads.front().size(); ++slot)
        for (const std::vector<Index>& operands : reads) {
          const std::size_t i = maker[at(operands[slot])];
          if (i == p_.steps.size() || placed[i] || done[group_of_[i]] || !groups_[group_of_[i]].alike) continue;
          placed[i] = true;
          ordered[group_of_[i]].push_back(i);
        }
    }
  }

  /// Puts steps in the order of groups, and numbers values in the order of steps.
  void number_values() {
    std::vector<Index> to(at(p_.rows), none);
    for (Index i = 0; i <= p_.time(); ++i) to[at(i)] = i;
    auto next = at(p_.time()) + 1;
    std::vector<Step> steps;
    for (const Group& group : groups_) {
      if (group.alike) {
        next = filled_up(next);
        made_.pieces.push_back({true, steps.size(), group.steps.size()});
        for (const bool weighted : {false, true}) {
          if (weighted && !group.kind.has_weighted) continue;
          for (std::size_t k = 0; k < group.steps.size(); ++k) {
            const Step& s = p_.steps[group.steps[k]];
            to[at(weighted ? s.weighted : s.out)] = static_cast<Index>(next + k);
          }
          next += filled_up(group.steps.size()) + width;  // its last batch may begin anywhere, and fills registers
        }
      } else {
        if (made_.pieces.empty() || made_.pieces.back().is_batch) made_.pieces.push_back({false, steps.size(), 0});
        made_.pieces.back().count += group.steps.size();
      }
      for (const std::size_t i : group.steps) steps.push_back(p_.steps[i]);
    }
    const auto number = [&](Index value) {
      if (to[at(value)] == none) to[at(value)] = static_cast<Index>(next++);
    };
    for (const auto* list : {&p_.linear, &steps})
      for (const Step& s : *list) number(s.out), number(s.weighted);
    for (const Index value : p_.weighted) number(value);
    p_.rows = static_cast<Index>(next);
    p_.steps = std::move(steps);
    const auto move = [&](Index& value) {
      if (value != none) value = to[at(value)];
    };
    for (auto* list : {&p_.linear, &p_.steps})
      for (Step& s : *list) {
        move(s.out);
        move(s.weighted);
        move(s.a);
        if (has_b(s.rule)) move(s.b);
        if (has_w(s.rule)) move(s.w);
      }
    for (Program::Value& term : p_.values) move(term.value);
    for (Program::Product& term : p_.products) move(term.a), move(term.b);
    for (auto* list : {&p_.lane_a, &p_.lane_b, &p_.rate, &p_.weighted, &p_.switches, &p_.poles, &p_.branches})
      for (Index& value : *list) move(value);
    for (SteepArgument& steep : p_.steep) move(steep.argument);
  }

  /// Sorts lanes by their factors, so that factors of adjacent lanes are adjacent values. Where they are not, the
  /// factors are copied behind all values in every order. Lanes that nothing reads are dropped.
  void number_lanes() {
    const std::size_t count = p_.lane_a.size();
    for (std::size_t i = 0; i < count; ++i)
      if (p_.lane_a[i] > p_.lane_b[i]) std::swap(p_.lane_a[i], p_.lane_b[i]);
    std::vector<bool> read(count, false);
    for (const Step& s : p_.steps) {
      if (has_lane(s.rule)) read[at(s.lane)] = true;
      if (s.rule == Rule::power) read[at(s.w)] = true;
    }
    for (const Program::Product& term : p_.products)
      if (term.lane != none) read[at(term.lane)] = true;
    std::vector<Index> to(count, none), a, b;
    const auto add = [&](std::span<const std::size_t> some, Index from_a, Index from_b) {
      const std::size_t room = a.size() + filled_up(some.size());
      for (std::size_t k = 0; k < some.size(); ++k) {
        if (k % width == 0) made_.lanes.push_back({from_a + static_cast<Index>(k), from_b + static_cast<Index>(k)});
        to[some[k]] = static_cast<Index>(a.size());
        a.push_back(p_.lane_a[some[k]]);
        b.push_back(p_.lane_b[some[k]]);
      }
      a.resize(room, Program::zero);
      b.resize(room, Program::zero);
    };
    const auto copy = [&](std::span<const std::size_t> some, const std::vector<Index>& from) {
      const Index first = p_.rows + static_cast<Index>(made_.copied.size());
      for (const std::size_t i : some) made_.copied.push_back(from[i]);
      return first;
    };
    for (const bool squares : {false, true}) {
      std::vector<std::size_t> all, remaining;
      for (std::size_t i = 0; i < count; ++i)
        if (read[i] && (p_.lane_a[i] == p_.lane_b[i]) == squares) all.push_back(i);
      std::ranges::sort(all, {}, [&](std::size_t i) { return std::tuple(p_.lane_a[i], p_.lane_b[i]); });
      for (std::size_t begin = 0, end = 1; begin < all.size(); begin = end++) {
        const auto goes_on = [&](std::size_t k) {
          return p_.lane_a[all[k]] == p_.lane_a[all[k - 1]] + 1 && p_.lane_b[all[k]] == p_.lane_b[all[k - 1]] + 1;
        };
        while (end < all.size() && goes_on(end)) ++end;
        const auto some = std::span(all).subspan(begin, end - begin);
        if (some.size() < fewest_alike) {
          remaining.insert(remaining.end(), some.begin(), some.end());
        } else {
          add(some, p_.lane_a[some.front()], p_.lane_b[some.front()]);
        }
      }
      const Index first = copy(remaining, p_.lane_a);
      add(remaining, first, squares ? first : copy(remaining, p_.lane_b));
      if (!squares) made_.mixed_lanes = made_.lanes.size();
    }
    const auto move = [&](Index& lane) {
      if (lane != none) lane = to[at(lane)];
    };
    for (Step& s : p_.steps) {
      if (has_lane(s.rule)) move(s.lane);
      if (s.rule == Rule::power) move(s.w);
    }
    for (Program::Product& term : p_.products) move(term.lane);
    p_.lane_a = std::move(a);
    p_.lane_b = std::move(b);
    for (auto* list : {&p_.low, &p_.high, &p_.slot}) list->clear();
  }

  /// Returns the column of `place(step)` of consecutive steps.
  template <class Place>
  Column column(std::span<const Step> steps, Place&& place) {
    const Index first = place(steps.front());
    bool follow = true;
    for (std::size_t k = 0; k < steps.size(); ++k) follow = follow && place(steps[k]) == first + static_cast<Index>(k);
    if (first == none || follow) return {first, false};
    const Column made{static_cast<Index>(made_.places.size()), true};
    for (const Step& s : steps) made_.places.push_back(place(s));
    made_.places.resize(at(made.first) + filled_up(steps.size()), Program::zero);
    return made;
  }

  /// Calls f, for each operand that steps like this one have, with a function that returns its place in a step.
  template <class F>
  void for_each_place(const Step& like, F&& f) const {
    if (reads_a(like.rule)) f(std::mem_fn(&Step::a));
    if (has_b(like.rule)) f(std::mem_fn(&Step::b));
    if (has_w(like.rule) || like.rule == Rule::power) f(std::mem_fn(&Step::w));
    if (has_lane(like.rule)) f(std::mem_fn(&Step::lane));
    for (Index i = 0; i < like.values; ++i)
      f([this, i](const Step& s) { return p_.values[at(s.first_value + i)].value; });
    for (Index i = 0; i < like.products; ++i)
      for (const auto part : {&Program::Product::a, &Program::Product::b, &Program::Product::lane})
        f([this, i, part](const Step& s) { return p_.products[at(s.first_product + i)].*part; });
  }

  /// Writes each group as one or several batches: a new batch begins where otherwise consecutive places of operands
  /// break. The padding behind a batch belongs to values that are computed after it.
  void write_batches() {
    constexpr std::size_t worth_it = width;  // steps of a batch, on average
    std::vector<Piece> found;
    std::vector<bool> begins;
    for (const Piece& piece : made_.pieces) {
      if (!piece.is_batch) {
        found.push_back(piece);
        continue;
      }
      const auto steps = std::span(p_.steps).subspan(piece.first, piece.count);
      begins.assign(piece.count, false);
      for_each_place(steps.front(), [&](auto&& place) {
        const auto breaks = [&](std::size_t k) { return place(steps[k]) != place(steps[k - 1]) + 1; };
        std::size_t count = 0;
        for (std::size_t k = 1; k < steps.size(); ++k) count += breaks(k) ? 1 : 0;
        if ((count + 1) * worth_it > steps.size()) return;
        for (std::size_t k = 1; k < steps.size(); ++k) begins[k] = begins[k] || breaks(k);
      });
      if ((static_cast<std::size_t>(std::ranges::count(begins, true)) + 1) * worth_it > steps.size())
        begins.assign(piece.count, false);
      for (std::size_t begin = 0, end = 1; begin < steps.size(); begin = end++) {
        while (end < steps.size() && !begins[end]) ++end;
        found.push_back({true, made_.batches.size(), 1});
        write_batch(steps.subspan(begin, end - begin));
      }
    }
    made_.pieces = std::move(found);
  }

  void write_batch(std::span<const Step> steps) {
    StepBatch& batch = made_.batches.emplace_back();
    const Step& like = steps.front();
    batch.rule = like.rule;
    batch.function = like.function;
    batch.count = steps.size();
    batch.room = filled_up(batch.count);
    batch.values = like.values;
    batch.products = like.products;
    batch.first_value = static_cast<Index>(made_.values.size());
    batch.first_product = static_cast<Index>(made_.products.size());
    batch.out = column(steps, std::mem_fn(&Step::out));
    if (like.weighted != Program::waste) batch.weighted = column(steps, std::mem_fn(&Step::weighted));
    std::vector<Column> columns;
    for_each_place(like, [&](auto&& place) { columns.push_back(column(steps, place)); });
    auto next = columns.begin();
    if (reads_a(like.rule)) batch.a = *next++;
    if (has_b(like.rule)) batch.b = *next++;
    if (has_w(like.rule) || like.rule == Rule::power) batch.w = *next++;
    if (has_lane(like.rule)) batch.lane = *next++;
    for (Index i = 0; i < like.values; ++i) made_.values.push_back({*next++});
    for (Index i = 0; i < like.products; ++i, next += 3) {
      const Program::Product& term = p_.products[at(like.first_product + i)];
      made_.products.push_back({next[0], term.a == term.b ? next[0] : next[1], next[2]});
    }
    batch.numbers = made_.numbers.size();
    const auto add_numbers = [&](auto&& of) {
      for (const Step& s : steps) made_.numbers.push_back(of(s));
      made_.numbers.resize(made_.numbers.size() + batch.room - batch.count);
    };
    add_numbers(std::mem_fn(&Step::c));
    add_numbers(std::mem_fn(&Step::p));
    for (Index i = 0; i < like.values; ++i)
      add_numbers([&](const Step& s) { return p_.values[at(s.first_value + i)].factor; });
    for (Index i = 0; i < like.products; ++i)
      add_numbers([&](const Step& s) { return p_.products[at(s.first_product + i)].factor; });
    batch.scratch = made_.scratch;
    made_.scratch += 3 * batch.room * (1 + at(like.products));
  }

  struct Group {
    Kind kind;
    bool alike;
    std::vector<std::size_t> steps;
  };

  Program& p_;
  StepBatches& made_;
  std::vector<Group> groups_;  ///< in the order in which they are computed
  std::vector<std::size_t> group_of_;
};

StepBatches::StepBatches(Program& program) {
  if (program.motion_steps > most_of_unrolled) share_products(program);
  Arrangement(program, *this);
}

}  // namespace least::tape
