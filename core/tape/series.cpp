#include "core/tape/series.hpp"

#include <cmath>

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

}  // namespace

struct Series::Engine {
  /// Order 0: the values themselves.
  static void begin(const Program& p, const std::vector<Step>& steps, double* row, double* inverse) {
    for (const Step& s : steps) {
      double& out = row[s.out];
      const double a = s.a == none ? 1 : row[s.a];
      switch (s.rule) {
        case Rule::sum:
          out = s.c;
          for (Index i = 0; i < s.values; ++i) {
            const auto& term = p.values[at(s.first_value + i)];
            out += term.factor * row[term.value];
          }
          for (Index i = 0; i < s.products; ++i) {
            const auto& term = p.products[at(s.first_product + i)];
            out += term.factor * (row[term.a] * row[term.b]);
          }
          break;
        case Rule::quotient:
        case Rule::linear_quotient:
          *inverse = 1 / row[s.b];
          out = s.c * a / row[s.b];
          break;
        case Rule::root:
          out = std::sqrt(a);
          *inverse = 0.5 / out;
          break;
        case Rule::power:
        case Rule::linear_power:
          out = std::pow(a, s.p);
          *inverse = 1 / a;
          break;
        case Rule::integral:
        case Rule::linear_integral:
          out = value_of(s.function, s.p * a);
          break;
        case Rule::log_like:
          out = value_of(s.function, a);
          *inverse = 1 / row[s.w];
          break;
        case Rule::select:
          *inverse = row[s.w] < 0;
          out = *inverse != 0 ? a : row[s.b];
          break;
        case Rule::linear_product:
          out = s.c * (a * row[s.w]);
          break;
      }
      row[s.weighted] = 0;
      ++inverse;
    }
  }

  /// Order k of the lanes but for what is new in it: Σ aⱼ b_{k−j}, 0 < j < k.
  [[gnu::always_inline]] static inline void convolve(std::size_t groups, std::size_t stride, std::size_t k,
                                                     const Four* a, const Four* b, Four* sums) {
    for (std::size_t g = 0; g < groups; ++g, a += stride, b += stride) {
      Four even{}, odd{};
      std::size_t j = 1;
      for (; j + 1 < k; j += 2) {
        even.lane += a[j].lane * b[k - j].lane;
        odd.lane += a[j + 1].lane * b[k - j - 1].lane;
      }
      if (j < k) even.lane += a[j].lane * b[k - j].lane;
      sums[g].lane = even.lane + odd.lane;
    }
  }

  /// Order k of the steps. `first`: order 0, `last`: order k − 1.
  [[gnu::always_inline]] static inline void advance(const Program& p, const std::vector<Step>& steps, std::size_t k,
                                                    const double* first, const double* second, const double* last,
                                                    double* row, const double* sums, const double* inverse) {
    const double order = static_cast<double>(k), part = inverses[k];
    for (const Step& s : steps) {
      double out = 0;
      switch (s.rule) {
        case Rule::sum: {
          const Program::Value* value = p.values.data() + s.first_value;
          for (const auto* end = value + s.values; value != end; ++value) out += value->factor * row[value->value];
          const Program::Product* term = p.products.data() + s.first_product;
          for (const auto* end = term + s.products; term != end; ++term)
            out += term->factor * (sums[term->lane] + (first[term->a] * row[term->b] + row[term->a] * first[term->b]));
          break;
        }
        case Rule::quotient:
          out = ((s.a == none ? 0 : s.c * row[s.a]) - (sums[s.lane] + row[s.b] * first[s.out])) * *inverse;
          break;
        case Rule::root:
          out = (row[s.a] - sums[s.lane]) * *inverse;
          break;
        case Rule::power:
          out = (s.p * (sums[s.lane] + row[s.b] * first[s.out]) - sums[s.w]) * (part * *inverse);
          break;
        case Rule::integral:
          out = s.c * part * (sums[s.lane] + row[s.b] * first[s.w]);
          break;
        case Rule::log_like:
          out = (s.c * row[s.b] - sums[s.lane]) * (part * *inverse);
          break;
        case Rule::select:
          out = *inverse != 0 ? row[s.a] : row[s.b];
          break;
        case Rule::linear_product:
          out = s.c * (first[s.a] * row[s.w] + second[s.a] * last[s.w]);
          break;
        case Rule::linear_quotient:
          out = ((s.a == none ? 0 : s.c * row[s.a]) - second[s.b] * last[s.out]) * *inverse;
          break;
        case Rule::linear_power:
          out = second[s.a] * last[s.out] * (s.p - order + 1) * (part * *inverse);
          break;
        case Rule::linear_integral:
          out = s.c * part * (second[s.a] * last[s.w]);
          break;
      }
      row[s.out] = out;
      row[s.weighted] = order * out;
      ++inverse;
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

  LEAST_WIDE static void expand(const Program& p, std::size_t orders, std::size_t stride, double* rows, double* inverse,
                                std::size_t groups, const Index* places, Four* a, Four* b, Four* sums) {
    double* const second = rows + stride;
    const auto per_group = orders + 1;
    begin(p, p.linear, rows, inverse);
    begin(p, p.steps, rows, inverse + p.linear.size());
    for (std::size_t k = 0; k < orders; ++k) {
      double* const row = rows + k * stride;
      if (k > 0) {
        convolve(groups, per_group, k, a, b, sums);
        const auto* flat = reinterpret_cast<const double*>(sums);
        if (k == 1) advance(p, p.linear, k, rows, second, rows, row, flat, inverse);
        advance(p, p.steps, k, rows, second, row - stride, row, flat, inverse + p.linear.size());
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

Series::Series(const Program& program, int order)
    : program_(program),
      order_(order),
      stride_(at(program_.rows)),
      groups_((program_.lane_a.size() + 3) / 4),
      rows_((static_cast<std::size_t>(order) + 1) * stride_),
      inverse_(program_.linear.size() + program_.steps.size()),
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
  Engine::expand(program_, static_cast<std::size_t>(order_), stride_, row, inverse_.data(), groups_, places_.data(),
                 left_.data(), right_.data(), sums_.data());
}

}  // namespace least::tape
