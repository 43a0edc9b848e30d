#include "core/tape/tangents.hpp"

#include <algorithm>
#include <cmath>

#include "core/tape/tangent_rules.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {
Kinds::Kinds(const Program& p) : moves(at(p.rows), false), reach(at(p.rows), everything) {
  for (std::size_t i = 0; i < p.variables; ++i) {
    moves[at(Program::first_variable) + i] = true;
    if (i >= p.moving) reach[at(Program::first_variable) + i] = 1;
  }
  reach[at(p.time())] = 2;
  for (const Step& s : p.linear) reach[at(s.out)] = 2;
  for (const Step& s : p.steps) {
    bool any = false;
    std::size_t furthest = 1;
    const auto see = [&](Index value) {
      any = any || moves[at(value)];
      furthest = std::max(furthest, reach[at(value)]);
    };
    for (Index i = 0; i < s.values; ++i) see(p.values[at(s.first_value + i)].value);
    for (Index i = 0; i < s.products; ++i) {
      see(p.products[at(s.first_product + i)].a);
      see(p.products[at(s.first_product + i)].b);
    }
    const bool two = s.rule == Rule::quotient || s.rule == Rule::linear_quotient || s.rule == Rule::select;
    if (s.rule != Rule::sum && s.a != none) see(s.a);
    if (two) see(s.b);
    if (s.rule == Rule::select || s.rule == Rule::linear_product) see(s.w);
    moves[at(s.out)] = any;
    reach[at(s.out)] = any && furthest == 1 ? 1 : everything;
  }
}

namespace {

/// Computes Σ cⱼ tⱼ over j < n for B sums side by side, which do not wait for each other, and for G fours of each from
/// four number f on. tⱼ are `on` fours apart.
template <std::size_t B, std::size_t G>
[[gnu::always_inline]] inline void sum_terms(const double* const* c, const Four* const* t, std::size_t on,
                                             std::size_t f, std::size_t n, Four* const* to) {
  Four sums[B][G];  // NOLINT: vectors
#pragma GCC unroll 4
  for (std::size_t b = 0; b < B; ++b)
#pragma GCC unroll 2
    for (std::size_t g = 0; g < G; ++g) sums[b][g].lane = Four{}.lane;
  for (std::size_t j = 0; j < n; ++j) {
#pragma GCC unroll 4
    for (std::size_t b = 0; b < B; ++b)
#pragma GCC unroll 2
      for (std::size_t g = 0; g < G; ++g) sums[b][g].lane += c[b][j] * t[b][j * on + f + g].lane;
  }
#pragma GCC unroll 4
  for (std::size_t b = 0; b < B; ++b)
#pragma GCC unroll 2
    for (std::size_t g = 0; g < G; ++g) to[b][f + g].lane = sums[b][g].lane;
}

}  // namespace

/// Pass computes one level, order by order. In a differentiated recurrence, the sums over tangents of orders below k
/// are computed first, several at a time; then tangents of order k are added, whose factors are known from order 0 of
/// the series.
class Tangents::Pass {
 public:
  Pass(Tangents& of, const Series& series, Level& level, const Level* first, const double* shares)
      : of_(of),
        p_(series.program()),
        level_(level),
        first_(first),
        shares_(shares),
        series_(series.coefficients(0) - Program::first_variable),
        stride_(series.stride()),
        fours_(level.fours) {}

  [[gnu::always_inline]] inline void go() {
    plan();
    for (k_ = 0; k_ < of_.order_; ++k_) {
      if (k_ > 0) find_sums();
      for (const Planned& planned : of_.planned_)
        if (k_ == 0 || planned.lasts) advance(planned);
      for (std::size_t i = 0; i < p_.moving; ++i) {
        Four* const next = level_.at(slot(Program::first_variable + static_cast<Index>(i)), k_ + 1);
        const Index rate = p_.rate[i];
        const bool known = moves(rate) && k_ < reach(rate);
        const Four* const here = known ? level_.at(slot(rate), k_) : nullptr;
        for (std::size_t f = 0; f < fours_; ++f) next[f].lane = known ? here[f].lane * inverses[k_ + 1] : Four{}.lane;
      }
    }
  }

 private:
  Index slot(Index value) const { return of_.slot_[at(value)]; }
  std::size_t reach(Index value) const { return of_.reach_[at(value)]; }
  bool moves(Index value) const { return value != none && slot(value) != none; }
  double value(Index value, std::size_t k = 0) const { return series_[k * stride_ + at(value)]; }

  void plan() {
    of_.planned_.clear();
    of_.terms_.clear();
    of_.sums_.clear();
    std::ranges::fill(of_.mirror_, none);
    for (std::size_t i = 0; i < p_.steps.size(); ++i) {
      const Step& s = p_.steps[i];
      if (!moves(s.out)) continue;
      Planned planned{i, of_.terms_.size(), 0, of_.sums_.size(), 0, reach(s.out) > 1};
      derive(p_, s, Taken{*this});
      planned.terms_end = of_.terms_.size();
      planned.sums_end = of_.sums_.size();
      of_.planned_.push_back(planned);
    }
    const std::size_t orders = of_.order_;
    Index mirrors = 0;
    for (Sum& sum : of_.sums_) {
      Index& mirror = of_.mirror_[at(sum.y)];
      if (mirror != none) continue;
      mirror = mirrors++;
      of_.mirrors_.resize(std::max(of_.mirrors_.size(), at(mirrors) * orders));
      double* const to = of_.mirrors_.data() + at(mirror) * orders;
      for (std::size_t k = 0; k < orders; ++k) to[orders - 1 - k] = value(sum.y, k);
    }
    for (Sum& sum : of_.sums_) {
      sum.series = of_.mirrors_.data() + at(of_.mirror_[at(sum.y)]) * orders + (orders - 1);
      sum.tangents = level_.at(sum.x, 0);
    }
    of_.weights_.resize(of_.sums_.size() * orders);
    of_.found_.resize(std::max(of_.found_.size(), of_.sums_.size() * fours_));
  }
  /// Taken appends the terms and sums of a step, with their factors, when `derive` calls it.
  struct Taken {
    Pass& pass;
    double value(Index value) const { return pass.value(value); }
    void add(Index x, double factor) {
      if (pass.moves(x)) pass.of_.terms_.push_back({pass.slot(x), pass.reach(x), factor});
    }
    void add_sum(Index x, Index y, double factor, double a, double b) {
      if (pass.moves(x) && pass.reach(y) > 1)
        pass.of_.sums_.push_back({pass.slot(x), y, pass.reach(x), pass.reach(y), factor, a, b, nullptr, nullptr});
    }
  };

  /// Computes all sums; those over all lower orders run four at a time.
  [[gnu::always_inline]] inline void find_sums() {
    constexpr std::size_t most = 4;
    const double* c[most];
    const Four* t[most];
    Four* to[most];
    std::size_t waiting = 0;
    for (std::size_t i = 0; i < of_.sums_.size(); ++i) {
      const Sum& sum = of_.sums_[i];
      c[waiting] = sum.series - k_;
      t[waiting] = sum.tangents;
      to[waiting] = of_.found_.data() + i * fours_;
      if (sum.a != 1 || sum.b != 0) {
        double* const __restrict weighted = of_.weights_.data() + i * of_.order_;
        const double* const __restrict plain = c[waiting];
        const double first = sum.a, step = sum.b * inverses[k_];
        for (int j = 0; j < static_cast<int>(k_); ++j) weighted[j] = (first + step * j) * plain[j];
        c[waiting] = weighted;
      }
      if (sum.x_reach <= k_ || sum.y_reach <= k_) {
        const std::size_t begin = k_ < sum.y_reach ? 0 : k_ + 1 - sum.y_reach, end = std::min(k_, sum.x_reach);
        for (std::size_t f = 0; f < fours_; ++f) {
          to[waiting][f].lane = Four{}.lane;
          for (std::size_t j = begin; j < end; ++j)
            to[waiting][f].lane += c[waiting][j] * t[waiting][j * fours_ + f].lane;
        }
        continue;
      }
      if (++waiting < most) continue;
      find<most>(c, t, to);
      waiting = 0;
    }
    for (std::size_t i = 0; i < waiting; ++i) find<1>(c + i, t + i, to + i);
  }
  template <std::size_t B>
  [[gnu::always_inline]] inline void find(const double* const* c, const Four* const* t, Four* const* to) {
    std::size_t f = 0;
    for (; f + 2 <= fours_; f += 2) sum_terms<B, 2>(c, t, fours_, f, k_, to);
    if (f < fours_) sum_terms<B, 1>(c, t, fours_, f, k_, to);
  }

  [[gnu::always_inline]] inline void advance(const Planned& planned) {
    const Step& s = p_.steps[planned.step];
    Four* const out = level_.at(slot(s.out), k_);
    const std::span terms = std::span(of_.terms_).subspan(planned.terms, planned.terms_end - planned.terms);
    for (std::size_t f = 0; f < fours_; ++f) {
      Four sum{};
      for (const Term& term : terms)
        if (k_ < term.reach) sum.lane += term.factor * level_.at(term.x, k_)[f].lane;
      if (k_ > 0)
        for (std::size_t i = planned.sums; i < planned.sums_end; ++i)
          sum.lane += of_.sums_[i].factor * of_.found_[i * fours_ + f].lane;
      out[f].lane = sum.lane;
    }
    if (first_) add_pairs(s, out->begin());
  }

  /// Adds to the second derivatives of a step what products of first derivatives contribute.
  void add_pairs(const Step& s, double* out) const {
    const double k = static_cast<double>(k_), part = k_ > 0 ? 1 / k : 1;
    switch (s.rule) {
      case Rule::sum:
        for (Index i = 0; i < s.products; ++i) {
          const Program::Product& term = p_.products[at(s.first_product + i)];
          add_pairs(term.a, term.b, term.factor, 0, out);
        }
        break;
      case Rule::quotient:
        add_pairs(s.out, s.b, -1 / value(s.b), 0, out);
        break;
      case Rule::root:
        add_pairs(s.out, s.out, -0.5 / value(s.out), 0, out);
        break;
      case Rule::power: {
        const double by = 1 / value(s.a);
        if (k_ == 0) add_pairs(s.a, s.a, 0.5 * s.p * (s.p - 1) * value(s.out) * by * by, 0, out);
        if (k_ > 0) add_pairs(s.a, s.out, -by, by * (1 + s.p) * part, out);
        break;
      }
      case Rule::integral:
        add_pairs(s.a, s.w, k_ > 0 ? 0 : 0.5 * s.c, k_ > 0 ? s.c * part : 0, out);
        break;
      case Rule::log_like: {
        const double by = 1 / value(s.w);
        add_pairs(s.w, s.out, k_ > 0 ? -by : -0.5 * by, k_ > 0 ? by * part : 0, out);
        break;
      }
      default:
        break;
    }
  }
  /// Adds Σ (α + β j) x′ⱼ y′_{k−j} for each pair, with the two directions of the pair and with these exchanged.
  void add_pairs(Index x, Index y, double alpha, double beta, double* out) const {
    if (!moves(x) || !moves(y)) return;
    const std::size_t end = std::min(k_ + 1, reach(x));
    for (std::size_t j = k_ < reach(y) ? 0 : k_ + 1 - reach(y); j < end; ++j) {
      const double of_order = alpha + static_cast<double>(j) * beta;
      const double *const a = first_->row(slot(x), j), *const b = first_->row(slot(y), k_ - j);
      for (std::size_t i = 0; i < of_.pairs_.size(); ++i) {
        const auto [d, e] = of_.pairs_[i];
        out[i] += shares_[i] * of_order * (a[d] * b[e] + a[e] * b[d]);
      }
    }
  }

  Tangents& of_;
  const Program& p_;
  Level& level_;
  const Level* first_;
  const double *shares_, *series_;
  std::size_t stride_, fours_, k_ = 0;
};

Tangents::Tangents(const Program& program, int order, std::size_t directions, std::vector<Pair> pairs)
    : variables_(program.variables),
      moving_(program.moving),
      order_(static_cast<std::size_t>(order)),
      pairs_(std::move(pairs)) {
  const Kinds kinds(program);
  reach_ = kinds.reach;
  slot_.assign(at(program.rows), none);
  for (std::size_t value = 0; value < slot_.size(); ++value)
    if (kinds.moves[value]) slot_[value] = slots_++;
  const std::array counts{directions, pairs_.size()};
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    levels_[i].fours = lanes_of(counts[i]) / 4;
    levels_[i].orders = order_ + 1;
    levels_[i].rows.resize(static_cast<std::size_t>(slots_) * levels_[i].orders * levels_[i].fours);
  }
  mirror_.resize(slot_.size());
}

std::size_t Tangents::numbers(const Program& program, int order, std::size_t directions, std::size_t pairs) {
  return at(program.rows) * (static_cast<std::size_t>(order) + 1) * (lanes_of(directions) + lanes_of(pairs));
}

void Tangents::begin(Level& level, std::span<const double> start) {
  const std::size_t lanes = 4 * level.fours;
  for (std::size_t i = 0; i < variables_; ++i)
    std::copy_n(start.data() + i * lanes, lanes, level.at(slot_[at(Program::first_variable) + i], 0)->begin());
}

LEAST_WIDE void Tangents::expand(const Series& series, std::span<const double> first, std::span<const double> second,
                                 std::span<const double> shares) {
  begin(levels_[0], first);
  Pass(*this, series, levels_[0], nullptr, nullptr).go();
  begin(levels_[1], second);
  if (!pairs_.empty()) Pass(*this, series, levels_[1], &levels_[0], shares.data()).go();
  told_ = order_;
  while (told_ > 0 && !std::isfinite(largest(static_cast<int>(told_)))) --told_;
}

double Tangents::largest(int order) const {
  double most = 0;
  for (const Level& level : levels_)
    for (std::size_t i = 0; i < moving_ && level.fours > 0; ++i) {
      const double* const row = level.row(slot_[at(Program::first_variable) + i], static_cast<std::size_t>(order));
      for (std::size_t l = 0; l < 4 * level.fours; ++l)
        if (const double here = std::abs(row[l]); !(here <= most)) most = here;
      if (std::isnan(most)) return most;
    }
  return most;
}

LEAST_WIDE void Tangents::evaluate(const Level& level, double h, std::span<double> end, std::span<double> low) const {
  for (std::size_t i = 0; i < moving_; ++i) {
    const Index slot = slot_[at(Program::first_variable) + i];
    for (std::size_t f = 0; f < level.fours; ++f) {
      Four sum{};
      for (std::size_t k = told_; k > 0; --k) sum.lane = (sum.lane + level.at(slot, k)[f].lane) * h;
      const std::size_t place = (i * level.fours + f) * 4;
      for (std::size_t l = 0; l < 4; ++l) {
        const double start = level.at(slot, 0)[f].lane[l], change = sum.lane[l] + low[place + l], to = start + change,
                     back = to - start;
        end[place + l] = to;
        low[place + l] = (start - (to - back)) + (change - back);
      }
    }
  }
}

void Tangents::evaluate(double h, std::span<double> first, std::span<double> first_low, std::span<double> second,
                        std::span<double> second_low) const {
  evaluate(levels_[0], h, first, first_low);
  evaluate(levels_[1], h, second, second_low);
}

}  // namespace least::tape
