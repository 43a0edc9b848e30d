#include "core/tape/closer_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tape/series_rules.hpp"
#include "core/tape/wide.hpp"

namespace least::tape {
namespace {

/// Visits the steps of a program, those linear in time first.
template <class Visit>
void each_step(const Program& program, Visit&& visit) {
  for (const Step& step : program.linear) visit(step);
  for (const Step& step : program.steps) visit(step);
}

/// Returns the value that a step divides by, or none.
Index divisor_of(const Step& s) {
  switch (s.rule) {
    case Rule::quotient:
    case Rule::linear_quotient:
      return s.b;
    case Rule::log_like:
      return s.w;
    case Rule::power:
    case Rule::linear_power:
      return s.p < 0 ? s.a : none;
    default:
      return none;
  }
}

}  // namespace

std::unique_ptr<CloserSeries> CloserSeries::of(const Program& program, int order) {
  constexpr std::size_t most_numbers = std::size_t(1) << 16;
  const std::size_t orders = static_cast<std::size_t>(order) + 1;
  if (std::ranges::all_of(program.steps, [](const Step& s) { return divisor_of(s) == none; }) ||
      at(program.rows) * orders > most_numbers)
    return nullptr;
  return std::unique_ptr<CloserSeries>(new CloserSeries(program, orders));
}

CloserSeries::CloserSeries(const Program& program, std::size_t orders) : orders_(orders), blurs_(at(program.rows), 0) {}

double CloserSeries::reach(const Program& program, const Workspace& of, double h) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Step& s : program.steps) {
    const Index divisor = divisor_of(s);
    if (divisor == none) continue;
    const auto size_of = [&](std::size_t k) { return std::abs(of.rows[k * of.stride + at(divisor)]); };
    const double here = size_of(0);
    double change = 0;
    for (std::size_t k = of.orders; k-- > 1;) change = (change + size_of(k)) * h;
    if (change < here) continue;
    for (std::size_t k = 1; k < of.orders; ++k)
      nearest = std::min(nearest, std::pow(here / size_of(k), 1 / static_cast<double>(k)));
  }
  return nearest;
}

double CloserSeries::blur(const Program& program, const double* row) {
  const auto blurred = [&](Index value) { return value == none ? 0 : blurs_[at(value)]; };
  each_step(program, [&](const Step& s) {
    const double out = row[s.out], a = s.a == none ? 1 : row[s.a];
    double by = 0, rounded = std::abs(out);  // error from the operands; magnitude that is rounded here
    switch (s.rule) {
      case Rule::sum:
        rounded = std::abs(s.c);
        for (Index i = s.first_value; i < s.first_value + s.values; ++i) {
          const Program::Value& term = program.values[at(i)];
          by += std::abs(term.factor) * blurred(term.value);
          rounded += std::abs(term.factor * row[term.value]);
        }
        [[fallthrough]];
      case Rule::integral:
      case Rule::linear_integral:
        if (s.rule != Rule::sum && s.products == 0) {
          by = std::abs(s.c * row[s.w]) * blurred(s.a);
          break;
        }
        for (Index i = s.first_product; i < s.first_product + s.products; ++i) {
          const Program::Product& term = program.products[at(i)];
          const double x = row[term.a], y = row[term.b], size = std::abs(term.factor);
          by += size * (std::abs(x) * blurred(term.b) + std::abs(y) * blurred(term.a));
          rounded += size * std::abs(x * y);
        }
        break;
      case Rule::quotient:
      case Rule::linear_quotient:
        by = (std::abs(s.c) * blurred(s.a) + std::abs(out) * blurred(s.b)) / std::abs(row[s.b]);
        break;
      case Rule::root:
        by = 0.5 * blurred(s.a) / out;
        break;
      case Rule::power:
      case Rule::linear_power:
        by = std::abs(s.p * out / a) * blurred(s.a);
        break;
      case Rule::log_like:
        by = std::abs(s.c / row[s.w]) * blurred(s.a);
        break;
      case Rule::select:
        by = row[s.w] < 0 ? blurred(s.a) : blurred(s.b);
        rounded = 0;
        break;
      case Rule::linear_product:
        by = std::abs(s.c) * (std::abs(a) * blurred(s.w) + std::abs(row[s.w]) * blurred(s.a));
        break;
    }
    blurs_[at(s.out)] = by + rounding * rounded;
  });
  double most = 0;
  for (std::size_t i = 0; i < program.moving; ++i) most = std::max(most, blurs_[at(program.rate[i])]);
  return most;
}

void CloserSeries::begin(const Program& program, const Step& s) {
  const auto here = [this](Index value) -> const DoubleDouble& { return row(value)[0]; };
  DoubleDouble& out = row(s.out)[0];
  const bool summed = s.rule == Rule::sum || s.products > 0;
  if (summed) {
    out = s.rule == Rule::sum ? DoubleDouble(s.c) : DoubleDouble();
    for (Index i = s.first_value; i < s.first_value + s.values; ++i)
      out += DoubleDouble(program.values[at(i)].factor) * here(program.values[at(i)].value);
    for (Index i = s.first_product; i < s.first_product + s.products; ++i) {
      const Program::Product& term = program.products[at(i)];
      out += DoubleDouble(term.factor) * (here(term.a) * here(term.b));
    }
    return;
  }
  switch (s.rule) {
    case Rule::quotient:
    case Rule::linear_quotient:
      out = DoubleDouble(s.c) * (s.a == none ? DoubleDouble(1) : here(s.a)) / here(s.b);
      break;
    case Rule::root:
      out = elementary(Op::sqrt, here(s.a));
      break;
    case Rule::power:
    case Rule::linear_power:
      out = power(here(s.a), s.p);
      break;
    case Rule::integral:
    case Rule::linear_integral:
      out = elementary(s.function, DoubleDouble(s.p) * here(s.a));
      break;
    case Rule::log_like:
      out = elementary(s.function, here(s.a));
      break;
    case Rule::select:
      out = here(s.w).high() < 0 ? here(s.a) : here(s.b);
      break;
    default:
      out = DoubleDouble(s.c) * (here(s.a) * here(s.w));
  }
}

/// Computes order k > 0 of a step.
void CloserSeries::advance(const Program& program, const Step& s, std::size_t k) {
  DoubleDouble* const out = row(s.out);
  const DoubleDouble* const a = s.a == none ? nullptr : row(s.a);
  const DoubleDouble over = DoubleDouble(1) / DoubleDouble(static_cast<double>(k));
  switch (s.rule) {
    case Rule::sum: {
      DoubleDouble sum{};
      for (Index i = s.first_value; i < s.first_value + s.values; ++i)
        sum += DoubleDouble(program.values[at(i)].factor) * row(program.values[at(i)].value)[k];
      for (Index i = s.first_product; i < s.first_product + s.products; ++i) {
        const Program::Product& term = program.products[at(i)];
        sum += DoubleDouble(term.factor) * convolve(row(term.a), row(term.b), k, 0, k);
      }
      out[k] = sum;
      break;
    }
    case Rule::quotient:
    case Rule::linear_quotient: {
      const DoubleDouble* const b = row(s.b);
      const DoubleDouble above = a ? DoubleDouble(s.c) * a[k] : DoubleDouble();
      out[k] = (above - convolve(b, out, k, 1, k)) / b[0];
      break;
    }
    case Rule::root:
      out[k] = (a[k] - (k > 1 ? square(out, k, 1) : DoubleDouble())) / (DoubleDouble(2) * out[0]);
      break;
    case Rule::power:
    case Rule::linear_power: {  // a ȯut = p ȧ out
      DoubleDouble sum{};
      for (std::size_t j = 1; j <= k; ++j)
        sum += DoubleDouble(s.p * static_cast<double>(j) - static_cast<double>(k - j)) * (a[j] * out[k - j]);
      out[k] = sum * over / a[0];
      break;
    }
    case Rule::integral:
    case Rule::linear_integral: {
      const DoubleDouble* const w = row(s.w);
      DoubleDouble sum{};
      for (std::size_t j = 1; j <= k; ++j) sum += DoubleDouble(static_cast<double>(j)) * (a[j] * w[k - j]);
      out[k] = DoubleDouble(s.c) * sum * over;
      break;
    }
    case Rule::log_like: {
      const DoubleDouble* const w = row(s.w);
      DoubleDouble sum{};
      for (std::size_t j = 1; j < k; ++j) sum += DoubleDouble(static_cast<double>(k - j)) * (w[j] * out[k - j]);
      out[k] = (DoubleDouble(s.c) * a[k] - sum * over) / w[0];
      break;
    }
    case Rule::select:
      out[k] = row(s.w)[0].high() < 0 ? a[k] : row(s.b)[k];
      break;
    case Rule::linear_product:
      out[k] = DoubleDouble(s.c) * convolve(a, row(s.w), k, 0, k);
      break;
  }
}

LEAST_FUSED void CloserSeries::expand(const Program& program, const Workspace& of) {
  rows_.assign(at(program.rows) * orders_, DoubleDouble());
  for (std::size_t i = 0; i < program.variables; ++i) row(Program::first_variable + static_cast<Index>(i))[0] = of.x[i];
  row(program.time())[0] = of.t;
  row(program.time())[1] = 1;
  for (std::size_t k = 0; k < of.orders; ++k) {
    each_step(program, [&](const Step& s) { k == 0 ? begin(program, s) : advance(program, s, k); });
    const DoubleDouble over = DoubleDouble(1) / DoubleDouble(static_cast<double>(k + 1));
    for (std::size_t i = 0; i < program.variables; ++i)
      row(Program::first_variable + static_cast<Index>(i))[k + 1] = over * row(program.rate[i])[k];
  }
  for (Index value = Program::first_variable; value < program.rows; ++value)
    for (std::size_t k = 0; k <= of.orders; ++k) of.rows[k * of.stride + at(value)] = row(value)[k].high();
}

}  // namespace least::tape
