#include "core/run/hermite.hpp"

namespace least {

HermitePath::End HermitePath::end_at(const ProblemTable& problem, StateView x) {
  const std::size_t count = problem.traits.numbers;
  End end{{x.t, StateNumbers(x.numbers, x.numbers + count)}, StateNumbers(count), StateNumbers(count)};
  problem.rates(x, end.first.data());
  problem.rates(x, end.first.data(), 1, end.first.data(), end.second.data());
  return end;
}

HermitePath::HermitePath(const ProblemTable& problem, StateView a, StateView b)
    : a_(end_at(problem, a)), b_(end_at(problem, b)) {}

RunState HermitePath::operator()(double t) const {
  const double h = b_.x.t - a_.x.t, u = (t - a_.x.t) / h, w = 1 - u;
  // The basis in u and w = 1 − u: at the other end each function vanishes with its first and second derivatives.
  const double w3 = w * w * w, u3 = u * u * u;
  const double a0 = w3 * (1 + 3 * u + 6 * u * u), a1 = w3 * (u + 3 * u * u) * h, a2 = w3 * u * u * 0.5 * h * h;
  const double b0 = u3 * (1 + 3 * w + 6 * w * w), b1 = -u3 * (w + 3 * w * w) * h, b2 = u3 * w * w * 0.5 * h * h;
  RunState x = a_.x;
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] =
        a0 * a_.x[i] + b0 * b_.x[i] + (a1 * a_.first[i] + b1 * b_.first[i]) + (a2 * a_.second[i] + b2 * b_.second[i]);
  x.t = t;
  return x;
}

}  // namespace least
