#include "core/tape/steep.hpp"

#include <limits>

#include "core/tape/series_rules.hpp"

namespace least::tape {
namespace {

using Kind = SteepArgument::Kind;

constexpr double nothing = -64, plenty = 100;  // e-foldings beyond which e^x is negligible, or large enough
constexpr double apart = 40;                   // sech x is negligible beyond ±40
constexpr double equal = 20;                   // tanh x is ±1 to the last bit beyond ±20
constexpr double weight = 3;  // of e-foldings of tanh: its slope 1 − tanh² loses digits where e^x keeps them
constexpr double high_power = 6;

/// Memory of a thread: arguments at one time and at all looks, a state within the step, and its rate.
struct Scratch {
  std::vector<double> values;
  std::vector<SteepLooks> looks;
  std::vector<double> within, rate;
};
Scratch& scratch(std::size_t arguments, std::size_t components) {
  thread_local Scratch kept;
  if (kept.values.size() < arguments) kept.values.resize(arguments);
  if (kept.looks.size() < arguments) kept.looks.resize(arguments);
  if (kept.within.size() < components) kept.within.resize(components);
  if (kept.rate.size() < components) kept.rate.resize(components);
  return kept;
}

/// Visits the steps that the motion needs: those linear in time, then the others.
template <class Visit>
void each_motion_step(const Program& program, Visit&& visit) {
  for (const Step& step : program.linear) visit(step);
  for (std::size_t i = 0; i < program.motion_steps; ++i) visit(program.steps[i]);
}

/// Returns, by node, whether the outputs depend on it.
std::vector<bool> needed_for(const Tape& tape, std::span<const Index> outputs) {
  std::vector<bool> needed(at(tape.size()), false);
  for (const Index output : outputs) needed[at(output)] = true;
  for (Index i = tape.size(); i-- > 0;)
    if (needed[at(i)])
      for (const Index part : {tape[i].a, tape[i].b, tape[i].c})
        if (part != none) needed[at(part)] = true;
  return needed;
}

}  // namespace

double SteepArgument::foldings(double value) const {
  switch (kind) {
    case Kind::exponential:
      return std::clamp(factor * value, nothing, plenty);
    case Kind::saturating:
      return weight * std::clamp(factor * value, -equal, equal);
    case Kind::hyperbolic:
      return std::clamp(factor * value, -apart, apart);
    default:
      return std::clamp(factor * std::log(std::abs(value)), nothing, plenty);
  }
}

bool SteepArgument::calm(double value, double change) const {
  return std::abs(factor) * change < (kind == Kind::power ? std::abs(value) : 1);
}

std::vector<SteepArgument> steep_arguments(const Program& program) {
  std::vector<SteepArgument> all;
  const auto add = [&](const SteepArgument& steep) {
    if (std::ranges::find(all, steep) == all.end()) all.push_back(steep);
  };
  each_motion_step(program, [&](const Step& step) {
    if (const auto kind = steepness(step.function))
      add({*kind, step.a, step.p});
    else if ((step.rule == Rule::power || step.rule == Rule::linear_power) && std::abs(step.p) >= high_power)
      add({Kind::power, step.a, step.p});
  });
  return all;
}

std::vector<SteepArgument> steep_arguments(const Tape& tape, std::span<const Index> outputs) {
  const std::vector<bool> wanted = needed_for(tape, outputs);
  std::vector<SteepArgument> all;
  for (Index i = tape.size(); i-- > 0;) {
    if (!wanted[at(i)]) continue;
    const Node& node = tape[i];
    if (const auto kind = steepness(node.op))
      all.push_back({*kind, node.a, 1});
    else if (node.op == Op::power && std::abs(node.value) >= high_power)
      all.push_back({Kind::power, node.a, node.value});
  }
  return all;
}

bool may_conceal(const Program& program) {
  constexpr double high = 8;
  std::vector<double> degrees(at(program.rows), 0);
  for (std::size_t i = 0; i <= program.variables; ++i) degrees[at(Program::first_variable) + i] = 1;
  std::vector<bool> offset(degrees.size(), false);  // a variable alone, or a sum with a constant
  for (std::size_t i = 0; i < program.variables; ++i) offset[at(Program::first_variable) + i] = true;
  bool conceals = false;
  each_motion_step(program, [&](const Step& step) {
    offset[at(step.out)] = step.rule == Rule::sum && step.c != 0;
    const double a = step.a == none ? 0 : degrees[at(step.a)];
    double degree = std::max(a, 1.0);
    switch (step.rule) {
      case Rule::sum:
        degree = 0;
        for (Index i = 0; i < step.values; ++i)
          degree = std::max(degree, degrees[at(program.values[at(step.first_value + i)].value)]);
        for (Index i = 0; i < step.products; ++i) {
          const Program::Product& product = program.products[at(step.first_product + i)];
          degree = std::max(degree, degrees[at(product.a)] + degrees[at(product.b)]);
        }
        break;
      case Rule::quotient:
      case Rule::linear_quotient:
        degree = a + degrees[at(step.b)];
        break;
      case Rule::root:
        degree = a / 2;
        conceals = conceals || offset[at(step.a)];
        break;
      case Rule::power:
      case Rule::linear_power:
        degree = std::abs(step.p) * a;
        break;
      case Rule::select:
        degree = std::max(a, degrees[at(step.b)]);
        break;
      case Rule::linear_product:
        degree = a + degrees[at(step.w)];
        break;
      default:
        break;
    }
    degrees[at(step.out)] = degree;
    conceals = conceals || degree > high;
  });
  return conceals;
}

std::vector<Index> branch_values(const Program& program) {
  std::vector<Index> all;
  each_motion_step(program, [&](const Step& step) {
    if (step.rule == Rule::root || (step.rule == Rule::power && step.p > 0 && step.p < 1)) all.push_back(step.a);
  });
  return all;
}

namespace {

/// Returns the nodes whose signs make the choices on which the outputs depend.
std::vector<Index> switches_of(const Tape& tape, std::span<const Index> outputs) {
  std::vector<Index> all;
  for (Index i = 0; i < tape.size(); ++i)
    if (tape[i].op == Op::select && std::ranges::find(all, tape[i].a) == all.end()) all.push_back(tape[i].a);
  if (all.empty()) return all;
  const std::vector<bool> wanted = needed_for(tape, outputs);
  std::erase_if(all, [&](Index i) { return !wanted[at(i)]; });
  return all;
}

/// Writes the state at the part `part` of a step, from 0 to 1, by cubic Hermite interpolation.
void place_within(const SteepStep& step, double part, double* y) {
  const double h = step.end.t - step.start.t, rest = 1 - part, time = part * h;
  const double a = rest * rest * (1 + 2 * part), b = part * part * (1 + 2 * rest);
  const double c = time * rest * rest, d = -time * part * rest;
  for (std::size_t i = 0; i < step.moving; ++i)
    y[i] = a * step.start.state[i] + b * step.end.state[i] + c * step.start.rate[i] + d * step.end.rate[i];
  if (step.complete) step.complete(step.problem, step.start.t + time, y);
}

/// Returns an argument at a part of the step by linear interpolation between looks.
double between(const SteepLooks& looks, double part) {
  const double place = part * (steep_looks - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(place), steep_looks - 2);
  const double beyond = place - static_cast<double>(k);
  return looks[k] + beyond * (looks[k + 1] - looks[k]);
}

}  // namespace

SteepForces::SteepForces(const Tape& tape, std::span<const Index> rates)
    : steep_(steep_arguments(tape, rates)), switches_(tape, switches_of(tape, rates)), variables_(rates.size()) {
  std::vector<Index> arguments;
  for (const SteepArgument& steep : steep_) arguments.push_back(steep.argument);
  arguments_ = Formula(tape, arguments);
  // One evaluation allocates the memory of the thread before the first step.
  Scratch& kept = scratch(std::max(steep_.size(), switches_.outputs()), variables_);
  switches_.evaluate(kept.within.data(), 0.0, kept.values.data());
  arguments_.evaluate(kept.within.data(), 0.0, kept.values.data());
}

double SteepForces::resolved_part(const SteepStep& step, double tolerance, std::int64_t& evaluations) const {
  constexpr double places[] = {0.3, 0.65};  // neither is the middle, where a force may vanish by symmetry
  constexpr double astray = 0.25, less = 0.95;
  const auto& [start, from, first_rate] = step.start;
  const auto& [end, to, last_rate] = step.end;
  const double h = end - start;
  if (const double part = until_switch(step, tolerance); part < h) return part;
  if (steep_.empty()) return h;
  auto& [values, looks, within, rate] = scratch(steep_.size(), std::max(variables_, step.components));
  for (const double part : places) {
    const double rest = 1 - part;
    for (std::size_t i = 0; i < step.components; ++i)
      within[i] = rest * rest * (1 + 2 * part) * from[i] + part * part * (1 + 2 * rest) * to[i] +
                  h * part * rest * (rest * first_rate[i] - part * last_rate[i]);
    step.rate(step.problem, start + part * h, within.data(), rate.data());
    ++evaluations;
    double speed = 0, off = 0, size = step.least_size;
    for (std::size_t i = 0; i < step.moving; ++i) {
      const double slope = 6 * part * rest * (to[i] - from[i]) / h + rest * (1 - 3 * part) * first_rate[i] +
                           part * (1 - 3 * rest) * last_rate[i];
      size = std::max(size, std::abs(to[i]));
      speed = std::max({speed, std::abs(first_rate[i]), std::abs(last_rate[i]), std::abs(slope)});
      off = std::max(off, std::abs(rate[i] - slope));
    }
    if (off > astray * speed && off * h > tolerance * size && start + 0.5 * h > start) return 0.5 * h;
  }
  const double part = resolved_length(step);
  return part < h && start + less * part > start ? less * part : h;
}

/// Follows the arguments along the cubic polynomials. A look evaluates all arguments, and each argument needs some
/// looks of its own: of thousands of arguments only the first ones get them, and the others are interpolated linearly.
double SteepForces::resolved_length(const SteepStep& step) const {
  constexpr std::size_t most_operations = 1 << 20;  // operations of these looks in a step: about a millisecond
  const double start = step.start.t, h = step.end.t - start;
  auto& [values, looks, within, last_rate] = scratch(steep_.size(), std::max(variables_, step.components));
  const auto observe = [&, &numbers = values, &y = within](double time) {
    place_within(step, time / h, y.data());
    arguments_.evaluate(y.data(), start + time, numbers.data());
  };
  for (std::size_t k = 0; k < steep_looks; ++k) {
    observe(h * static_cast<double>(k) / (steep_looks - 1));
    for (std::size_t i = 0; i < steep_.size(); ++i) looks[i][k] = values[i];
  }
  double length = h;
  std::size_t closer = most_operations / std::max<std::size_t>(arguments_.operations(), 1);  // looks that are left
  for (std::size_t i = 0; i < steep_.size(); ++i) {
    const auto [least, most] = std::minmax_element(looks[i].begin(), looks[i].end());
    if (steep_[i].calm(looks[i].front(), *most - *least)) continue;
    const auto value = [&, &numbers = values, &known = looks[i]](double time) {
      if (closer == 0) return between(known, time / h);
      --closer;
      observe(time);
      return numbers[i];
    };
    length = std::min(length, tape::resolved_length(steep_[i], h, most_of_pair, looks[i], value));
  }
  return length;
}

/// The step has to end right before the first choice changes. The next step then hops over the change, which costs no
/// accuracy: during the hop the state hardly moves, or the hop is as short as the rounding of the time.
double SteepForces::until_switch(const SteepStep& step, double tolerance) const {
  const std::size_t count = switches_.outputs();
  const double h = step.end.t - step.start.t;
  if (count == 0) return h;
  constexpr int halvings = 60;
  constexpr double little = 0.01, rounding = 16 * std::numeric_limits<double>::epsilon();
  double speed = 0, size = step.least_size;
  for (std::size_t i = 0; i < step.moving; ++i) {
    speed = std::max({speed, std::abs(step.start.rate[i]), std::abs(step.end.rate[i])});
    size = std::max(size, std::abs(step.end.state[i]));
  }
  const double hop = std::max(little * tolerance * size / speed, rounding * std::abs(step.end.t));
  if (h <= 2 * hop) return h;
  auto& [values, looks, within, rate] = scratch(std::max(count, steep_.size()), std::max(variables_, step.components));
  const auto observe = [&, &numbers = values, &y = within](double part) {
    place_within(step, part, y.data());
    switches_.evaluate(y.data(), step.start.t + part * h, numbers.data());
  };
  for (std::size_t k = 0; k < steep_looks; ++k) {
    observe(static_cast<double>(k) / (steep_looks - 1));
    for (std::size_t i = 0; i < count; ++i) looks[i][k] = values[i];
  }
  // Bisects for all choices at once, between the first two looks between which any of them changes: many choices take
  // as many looks as one.
  const auto changed = [&seen = looks](std::size_t i, std::size_t k) {
    return (seen[i][k - 1] < 0) != (seen[i][k] < 0);
  };
  std::size_t change = steep_looks;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 1; k < change; ++k)
      if (changed(i, k)) change = k;
  if (change == steep_looks) return h;
  double low = static_cast<double>(change - 1) / (steep_looks - 1);
  double first = static_cast<double>(change) / (steep_looks - 1);
  for (int n = 0; n < halvings; ++n) {
    const double middle = 0.5 * (low + first);
    observe(middle);
    bool any = false;
    for (std::size_t i = 0; i < count && !any; ++i)
      any = changed(i, change) && (values[i] < 0) != (looks[i][change - 1] < 0);
    (any ? first : low) = middle;
  }
  if (!(first < 1)) return h;
  return first * h > hop ? first * h - 0.5 * hop : first * h + 0.5 * hop;
}

}  // namespace least::tape
