#include "core/tape/batches.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "core/number/math.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {

namespace {

constexpr std::size_t few_steps = 200;  // below, one after the other is as fast
constexpr std::size_t few_alike = 5;    // in a batch, on average
// Scenes of few coordinates have many formulas, and every request has its own: what batches hold of them, ten bytes an
// operation, is dearer than the time that they save.
constexpr std::ptrdiff_t few_variables = 17;

bool has_number(Code code) {
  switch (code) {
    case Code::constant:
    case Code::add_constant:
    case Code::from_constant:
    case Code::scale:
    case Code::over:
    case Code::power:
      return true;
    default:
      return false;
  }
}

}  // namespace

/// Orders steps by how many must come before them, gives every batch a range of places, and frees it after its last
/// reader.
class Batches::Scheduler {
 public:
  Scheduler(std::span<const Operation> steps, std::span<const Index> ends) : steps_(steps), ends_(ends) { group(); }

  bool worthwhile() const { return steps_.size() >= few_alike * groups_.size(); }

  void schedule(Batches& made) {
    find_last_readers();
    place_.resize(steps_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      std::vector<Index>& group = groups_[g];
      order(group);
      Batch batch{.code = steps_[at(group[0])].code, .count = static_cast<std::uint32_t>(group.size())};
      batch.value = static_cast<std::uint32_t>(made.values_.size());
      if (has_number(batch.code))
        for (const Index i : group) made.values_.push_back(steps_[at(i)].value);
      batch.a = operand(made, group, &Operation::a);
      batch.b = operand(made, group, &Operation::b);
      batch.c = operand(made, group, &Operation::c);
      batch.out = take(batch.count);
      for (std::size_t k = 0; k < group.size(); ++k) place_[at(group[k])] = batch.out + static_cast<Place>(k);
      made.batches_.push_back(batch);
      for (const std::size_t ended : ending_[g])
        release(place_[at(groups_[ended][0])], static_cast<Place>(groups_[ended].size()));
    }
    for (const Index end : ends_) made.ends_.push_back(place_[at(end)]);
    made.room_ = room_;
  }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }

  template <class F>
  void for_each_part(const Operation& step, F&& f) const {
    if (step.code == Code::variable) return;
    for (const Index part : {step.a, step.b, step.c})
      if (part != none) f(part);
  }

  void group() {
    std::vector<int> depth(steps_.size(), 0);
    std::map<std::pair<int, Code>, std::size_t> known;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      for_each_part(steps_[i], [&](Index part) { depth[i] = std::max(depth[i], depth[at(part)] + 1); });
      ++known[{depth[i], steps_[i].code}];
    }
    std::size_t count = 0;
    for (auto& [_, number] : known) number = count++;
    groups_.resize(count);
    group_of_.resize(steps_.size());
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      group_of_[i] = known[{depth[i], steps_[i].code}];
      groups_[group_of_[i]].push_back(static_cast<Index>(i));
    }
  }

  /// Which batches have their last reader where.
  void find_last_readers() {
    constexpr std::size_t never = static_cast<std::size_t>(-1);
    std::vector<std::size_t> last(groups_.size());
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t i = 0; i < steps_.size(); ++i)
      for_each_part(steps_[i], [&](Index part) {
        std::size_t& reader = last[group_of_[at(part)]];
        reader = std::max(reader, group_of_[i]);
      });
    for (const Index end : ends_) last[group_of_[at(end)]] = never;
    ending_.resize(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (last[g] != never) ending_[last[g]].push_back(g);
  }

  Place source(Index i, Index Operation::*part) const {
    const Operation& step = steps_[at(i)];
    const Index from = step.*part;
    return step.code == Code::variable ? static_cast<Place>(from) : place_[at(from)];
  }
  bool reads(const std::vector<Index>& group, Index Operation::*part) const {
    return steps_[at(group[0])].*part != none;
  }

  std::size_t scattered(const std::vector<Index>& group) const {
    std::size_t count = 0;
    for (Index Operation::*part : {&Operation::a, &Operation::b, &Operation::c})
      for (std::size_t k = 1; k < group.size() && reads(group, part); ++k)
        if (source(group[k], part) != source(group[k - 1], part) + 1) ++count;
    return count;
  }

  /// The order in which most operands stand one after the other: as written, or by the place of one operand.
  void order(std::vector<Index>& group) const {
    std::vector<Index> best = group;
    std::size_t fewest = scattered(group);
    for (Index Operation::*part : {&Operation::a, &Operation::b}) {
      if (fewest == 0 || !reads(group, part)) break;
      std::vector<Index> sorted = group;
      std::ranges::stable_sort(sorted, {}, [&](Index i) { return source(i, part); });
      if (const std::size_t count = scattered(sorted); count < fewest) {
        fewest = count;
        best = std::move(sorted);
      }
    }
    group = std::move(best);
  }

  Operand operand(Batches& made, const std::vector<Index>& group, Index Operation::*part) const {
    if (!reads(group, part)) return {};
    bool scattered = false;
    for (std::size_t k = 1; k < group.size(); ++k)
      scattered = scattered || source(group[k], part) != source(group[k - 1], part) + 1;
    if (!scattered) return {false, source(group[0], part)};
    const Operand where{true, static_cast<std::uint32_t>(made.places_.size())};
    for (const Index i : group) made.places_.push_back(source(i, part));
    return where;
  }

  /// The first free range that is long enough.
  Place take(Place count) {
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      if (range->second < count) continue;
      const auto [from, length] = *range;
      free_.erase(range);
      if (length > count) free_[from + count] = length - count;
      return from;
    }
    const Place from = static_cast<Place>(room_);
    room_ += count;
    return from;
  }
  void release(Place from, Place count) {
    auto next = free_.lower_bound(from);
    if (next != free_.end() && next->first == from + count) {
      count += next->second;
      next = free_.erase(next);
    }
    if (next != free_.begin()) {
      const auto before = std::prev(next);
      if (before->first + before->second == from) {
        before->second += count;
        return;
      }
    }
    free_[from] = count;
  }

  std::span<const Operation> steps_;
  std::span<const Index> ends_;
  std::vector<std::vector<Index>> groups_;  ///< steps, in the order of evaluation
  std::vector<std::size_t> group_of_;
  std::vector<std::vector<std::size_t>> ending_;
  std::vector<Place> place_;
  std::map<Place, Place> free_;  ///< from, how many
  std::size_t room_ = 0;
};

std::shared_ptr<const Batches> Batches::of(std::span<const Operation> steps, std::span<const Index> ends) {
  const auto variables = std::ranges::count(steps, Code::variable, &Operation::code);
  if (steps.size() < few_steps || variables <= few_variables) return nullptr;
  Scheduler scheduler(steps, ends);
  if (!scheduler.worthwhile()) return nullptr;
  const auto made = std::make_shared<Batches>();
  scheduler.schedule(*made);
  return made;
}

namespace {

constexpr std::size_t block = 256;  // values that are gathered at a time: what an operand has stays near

/// out[k] = f(of every operand's k-th value), in a loop that the compiler makes wide.
template <class F, class... Values>
__attribute__((always_inline)) inline void each(F f, std::size_t count, double* __restrict out, Values... of) {
  for (std::size_t k = 0; k < count; ++k) out[k] = f(of[k]...);
}

}  // namespace

LEAST_WIDE void Batches::evaluate(const double* x, double t, double* out) const noexcept {
  thread_local std::vector<double> values;
  if (values.size() < room_) values.resize(room_);
  double* const r = values.data();
  std::array<double, block> first, second, third;  // NOLINT: written before they are read
  for (const Batch& batch : batches_) {
    const double* const from = batch.code == Code::variable ? x : r;
    for (std::size_t begin = 0; begin < batch.count; begin += block) {
      const std::size_t count = std::min(block, batch.count - begin);
      const auto operand = [&](const Operand& which, std::array<double, block>& gathered) {
        if (!which.scattered) return from + which.at + begin;
        const Place* const places = &places_[which.at + begin];
        for (std::size_t k = 0; k < count; ++k) gathered[k] = from[places[k]];
        return static_cast<const double*>(gathered.data());
      };
      double* const o = r + batch.out + begin;
      const double* const a = operand(batch.a, first);
      const double* const v = values_.data() + batch.value + begin;
      const auto unary = [&](auto f) __attribute__((always_inline)) { each(f, count, o, a); };
      const auto binary = [&](auto f) __attribute__((always_inline)) {
        each(f, count, o, a, operand(batch.b, second));
      };
      const auto with = [&](auto f) __attribute__((always_inline)) { each(f, count, o, a, v); };
      switch (batch.code) {
        case Code::constant:
          std::copy_n(v, count, o);
          break;
        case Code::variable:
          std::copy_n(a, count, o);
          break;
        case Code::time:
          std::fill_n(o, count, t);
          break;
        case Code::add:
          binary([](double p, double q) { return p + q; });
          break;
        case Code::subtract:
          binary([](double p, double q) { return p - q; });
          break;
        case Code::multiply:
          binary([](double p, double q) { return p * q; });
          break;
        case Code::divide:
          binary([](double p, double q) { return p / q; });
          break;
        case Code::add_constant:
          with([](double p, double value) { return p + value; });
          break;
        case Code::from_constant:
          with([](double p, double value) { return value - p; });
          break;
        case Code::scale:
          with([](double p, double value) { return p * value; });
          break;
        case Code::over:
          with([](double p, double value) { return value / p; });
          break;
        case Code::power:
          with([](double p, double value) { return least::pow(p, value); });
          break;
        case Code::sqrt:
          unary([](double p) { return least::sqrt(p); });
          break;
        case Code::exp:
          unary([](double p) { return least::exp(p); });
          break;
        case Code::log:
          unary([](double p) { return least::log(p); });
          break;
        case Code::sin:
          unary([](double p) { return least::sin(p); });
          break;
        case Code::cos:
          unary([](double p) { return least::cos(p); });
          break;
        case Code::tan:
          unary([](double p) { return least::tan(p); });
          break;
        case Code::sinh:
          unary([](double p) { return least::sinh(p); });
          break;
        case Code::cosh:
          unary([](double p) { return least::cosh(p); });
          break;
        case Code::tanh:
          unary([](double p) { return least::tanh(p); });
          break;
        case Code::atan:
          unary([](double p) { return least::atan(p); });
          break;
        case Code::asin:
          unary([](double p) { return least::asin(p); });
          break;
        case Code::acos:
          unary([](double p) { return least::acos(p); });
          break;
        case Code::select:
          each([](double p, double q, double s) { return p < 0 ? q : s; }, count, o, a, operand(batch.b, second),
               operand(batch.c, third));
          break;
      }
    }
  }
  for (std::size_t i = 0; i < ends_.size(); ++i) out[i] = r[ends_[i]];
}

}  // namespace least::tape
