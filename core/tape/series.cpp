#include "core/tape/series.hpp"

#include <cmath>
#include <utility>

// Where the machine has wider registers, they are used: what is computed is the same.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LEAST_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LEAST_WIDE
#endif

namespace least::tape {
namespace {

constexpr std::size_t at(Index i) { return static_cast<std::size_t>(i); }

constexpr auto inverses = [] {
  std::array<double, Series::most_orders + 1> all{};
  for (std::size_t k = 1; k < all.size(); ++k) all[k] = 1 / static_cast<double>(k);
  return all;
}();

double value_of(Op function, double x) {
  switch (function) {
    case Op::exp:
      return std::exp(x);
    case Op::log:
      return std::log(x);
    case Op::sin:
      return std::sin(x);
    case Op::cos:
      return std::cos(x);
    case Op::tan:
      return std::tan(x);
    case Op::sinh:
      return std::sinh(x);
    case Op::cosh:
      return std::cosh(x);
    case Op::tanh:
      return std::tanh(x);
    case Op::atan:
      return std::atan(x);
    case Op::asin:
      return std::asin(x);
    default:
      return std::acos(x);
  }
}

/// Powers of distances are halves.
double power_of(double x, double p) {
  if (p == -1.5) return 1 / (x * std::sqrt(x));
  if (p == -0.5) return 1 / std::sqrt(x);
  if (p == 1.5) return x * std::sqrt(x);
  return std::pow(x, p);
}

}  // namespace

struct Series::Engine {
  /// Order 0: the values themselves.
  static void begin(const Program& p, const std::vector<Step>& steps, double* row) {
    for (const Step& s : steps) {
      double& out = row[s.out];
      const double a = s.a == none ? 1 : row[s.a];
      switch (s.rule) {
        case Rule::sum: {
          double sum = s.c;
          for (Index i = 0; i < s.values; ++i) {
            const auto& term = p.values[at(s.first_value + i)];
            sum += term.factor * row[term.value];
          }
          for (Index i = 0; i < s.products; ++i) {
            const auto& term = p.products[at(s.first_product + i)];
            sum += term.factor * (row[term.a] * row[term.b]);
          }
          out = sum;
          break;
        }
        case Rule::quotient:
        case Rule::linear_quotient:
          out = s.c * a / row[s.b];
          break;
        case Rule::root:
          out = std::sqrt(a);
          break;
        case Rule::power:
        case Rule::linear_power:
          out = power_of(a, s.p);
          break;
        case Rule::integral:
        case Rule::linear_integral:
          out = value_of(s.function, s.p * a);
          break;
        case Rule::log_like:
          out = value_of(s.function, a);
          break;
        case Rule::select:
          out = row[s.w] < 0 ? a : row[s.b];
          break;
        case Rule::linear_product:
          out = s.c * (a * row[s.w]);
          break;
      }
    }
  }

  /// What the terms of order 0 are multiplied with in every order.
  static Gain gain_of(const Step& s, const double* row) {
    switch (s.rule) {
      case Rule::quotient:
      case Rule::linear_quotient: {
        const double inverse = 1 / row[s.b];
        return {inverse, s.a == none ? 0 : s.c * inverse, row[s.out] * inverse};
      }
      case Rule::root:
        return {0.5 / row[s.out], 0, 0};
      case Rule::power:
      case Rule::linear_power:
        return {1 / row[s.a], s.p * row[s.out] / row[s.a], 0};
      case Rule::integral:
        return {0, s.c * row[s.w], 0};
      case Rule::log_like:
        return {1 / row[s.w], s.c / row[s.w], 0};
      case Rule::select:
        return {row[s.w] < 0 ? 1.0 : 0.0, 0, 0};
      case Rule::linear_product:
        return {0, row[s.a], 0};
      default:
        return {};
    }
  }

  /// Order k of the lanes but for what is new in it or in the last: Σ aⱼ b_{k−j}, 1 < j < k − 1.
  [[gnu::always_inline]] static inline void convolve(std::size_t groups, std::size_t stride, std::size_t k,
                                                     const Four* a, const Four* b, Four* sums) {
    for (std::size_t g = 0; g < groups; ++g, a += stride, b += stride) {
      Four even{}, odd{};
      std::size_t j = 2;
      for (; j + 2 < k; j += 2) {
        even.lane += a[j].lane * b[k - j].lane;
        odd.lane += a[j + 1].lane * b[k - j - 1].lane;
      }
      if (j + 1 < k) even.lane += a[j].lane * b[k - j].lane;
      sums[g].lane = even.lane + odd.lane;
    }
  }

  /// Order k of the steps, at `row`; `second`: order 1, `last`: order k − 1. From one order to the next the way leads
  /// through the terms that are new: they are multiplied once and come last.
  [[gnu::always_inline]] static inline void advance(const Program& p, const std::vector<Step>& steps, std::size_t k,
                                                    const double* second, const double* last, double* row,
                                                    const double* sums, const Gain* gain, const Ends* ends) {
    const double order = static_cast<double>(k), part = inverses[k];
    const double twice = k > 2 ? 1 : 0.5;  // of order 2 the two terms of order 1 are one
    // Σ aⱼ b_{k−j}, 0 < j < k: what has just been written is read one by one, not by fours.
    const auto old = [&](Index lane, Index a, Index b) {
      return k > 1 ? sums[lane] + twice * (second[a] * last[b] + last[a] * second[b]) : 0;
    };
    for (const Step& s : steps) {
      double out = 0;
      switch (s.rule) {
        case Rule::sum: {
          double base = 0;
          const Program::Product* term = p.products.data() + s.first_product;
          const Ends* by = ends + s.first_product;
          for (const auto* end = term + s.products; term != end; ++term, ++by) {
            base += term->factor * old(term->lane, term->a, term->b);
            out += row[term->a] * by->b + row[term->b] * by->a;
          }
          const Program::Value* value = p.values.data() + s.first_value;
          for (const auto* end = value + s.values; value != end; ++value) out += value->factor * row[value->value];
          out += base;
          break;
        }
        case Rule::quotient:
          out = gain->a * (s.a == none ? 0 : row[s.a]) - old(s.lane, s.b, s.out) * gain->inverse - row[s.b] * gain->b;
          break;
        case Rule::root:
          out = (row[s.a] - old(s.lane, s.out, s.out)) * gain->inverse;
          break;
        case Rule::power:
          out =
              (s.p * old(s.lane, s.b, s.out) - old(s.w, s.a, s.weighted)) * (part * gain->inverse) + row[s.a] * gain->a;
          break;
        case Rule::integral:
          out = (s.c * part) * old(s.lane, s.b, s.w) + row[s.a] * gain->a;
          break;
        case Rule::log_like:
          out = row[s.a] * gain->a - old(s.lane, s.w, s.weighted) * (part * gain->inverse);
          break;
        case Rule::select:
          out = gain->inverse != 0 ? row[s.a] : row[s.b];
          break;
        case Rule::linear_product:
          out = s.c * (row[s.w] * gain->a + second[s.a] * last[s.w]);
          break;
        case Rule::linear_quotient:
          out = gain->a * (s.a == none ? 0 : row[s.a]) - second[s.b] * last[s.out] * gain->inverse;
          break;
        case Rule::linear_power:
          out = second[s.a] * last[s.out] * (s.p - order + 1) * (part * gain->inverse);
          break;
        case Rule::linear_integral:
          out = s.c * part * (second[s.a] * last[s.w]);
          break;
      }
      row[s.out] = out;
      row[s.weighted] = order * out;
      ++gain;
    }
  }

  /// Order k of the values becomes that of the lanes.
  [[gnu::always_inline]] static inline void spread(std::size_t groups, std::size_t stride, std::size_t k,
                                                   const double* row, const Index* places, Four* a, Four* b) {
    for (std::size_t g = 0; g < groups; ++g, places += 8) {
      a[g * stride + k] = Four{{row[places[0]], row[places[1]], row[places[2]], row[places[3]]}};
      b[g * stride + k] = Four{{row[places[4]], row[places[5]], row[places[6]], row[places[7]]}};
    }
  }

  LEAST_WIDE static void expand(const Program& p, std::size_t orders, std::size_t stride, double* rows, Gain* gains,
                                Ends* ends, std::size_t groups, const Index* places, Four* a, Four* b, Four* sums) {
    const std::size_t per_group = orders + 1;
    Gain* const rest = gains + p.linear.size();
    begin(p, p.linear, rows);
    begin(p, p.steps, rows);
    for (std::size_t i = 0; i < p.steps.size(); ++i) rest[i] = gain_of(p.steps[i], rows);
    for (std::size_t i = 0; i < p.products.size(); ++i) {
      const Program::Product& term = p.products[i];
      ends[i] = {term.factor * rows[term.a], term.factor * rows[term.b]};
    }
    for (std::size_t k = 0; k < orders; ++k) {
      double* const row = rows + k * stride;
      if (k > 0) {
        convolve(groups, per_group, k, a, b, sums);
        const auto* flat = reinterpret_cast<const double*>(sums);
        const double *const second = rows + stride, *const last = row - stride;
        if (k == 1) advance(p, p.linear, k, second, last, row, flat, gains, ends);
        advance(p, p.steps, k, second, last, row, flat, rest, ends);
      }
      double* const next = row + stride;
      for (std::size_t i = 0; i < p.variables; ++i) {
        const double rate = row[p.rate[i]];
        next[at(Program::first_variable) + i] = rate * inverses[k + 1];
        next[p.weighted[i]] = rate;
      }
      spread(groups, per_group, k, row, places, a, b);
    }
  }
};

Series::Series(Program program, int order)
    : program_(std::move(program)),
      order_(order),
      stride_(at(program_.rows)),
      groups_((program_.lane_a.size() + 3) / 4),
      rows_((static_cast<std::size_t>(order) + 1) * stride_ + 4),
      trial_(stride_),
      gains_(program_.linear.size() + program_.steps.size()),
      ends_(program_.products.size()),
      left_(groups_ * (static_cast<std::size_t>(order) + 1)),
      right_(left_.size()),
      sums_(groups_),
      places_(8 * groups_, Program::zero) {
  for (std::size_t i = 0; i < program_.lane_a.size(); ++i) {
    places_[8 * (i / 4) + i % 4] = program_.lane_a[i];
    places_[8 * (i / 4) + 4 + i % 4] = program_.lane_b[i];
  }
}

void Series::expand(const double* x, double t) {
  double* const row = rows_.data();
  for (std::size_t i = 0; i < program_.variables; ++i) row[at(Program::first_variable) + i] = x[i];
  row[program_.time()] = t;
  row[stride_ + at(program_.time())] = 1;
  row[stride_ + at(program_.weighted.back())] = 1;
  Engine::expand(program_, static_cast<std::size_t>(order_), stride_, row, gains_.data(), ends_.data(), groups_,
                 places_.data(), left_.data(), right_.data(), sums_.data());
}

bool Series::defined(const double* x, double t) {
  for (std::size_t i = 0; i < program_.variables; ++i) trial_[at(Program::first_variable) + i] = x[i];
  trial_[at(program_.time())] = t;
  Engine::begin(program_, program_.linear, trial_.data());
  Engine::begin(program_, program_.steps, trial_.data());
  for (std::size_t i = 0; i < program_.moving; ++i)
    if (!std::isfinite(trial_[at(program_.rate[i])])) return false;
  return true;
}

}  // namespace least::tape
