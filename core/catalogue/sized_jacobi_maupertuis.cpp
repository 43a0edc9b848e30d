#include "core/catalogue/sized_jacobi_maupertuis.hpp"

#include <algorithm>

namespace least {

template <class Motion>
void SizedJacobiMaupertuis<Motion>::put(const T* x) {
  auto& here = hybrid_.here();
  const std::size_t n = here.q.size();
  std::copy_n(x, n, here.q.begin());
  std::copy_n(x + n, n, here.p.begin());
}

template <class Motion>
void SizedJacobiMaupertuis<Motion>::begin(const T* x, const T& level) {
  put(x);
  hybrid_.start_anew(level);
  hybrid_.look();
}

template <class Motion>
StepStatus SizedJacobiMaupertuis<Motion>::step(T* x, T& h) noexcept {
  put(x);
  if (const StepStatus status = hybrid_.step(); status != StepStatus::ok) return status;
  const auto& here = hybrid_.here();
  std::ranges::copy(here.q, x);
  std::ranges::copy(here.p, x + here.q.size());
  h = here.elapsed;
  return StepStatus::ok;
}

template <class Motion>
double SizedJacobiMaupertuis<Motion>::discrete_energy(const RunState& a, const RunState& b,
                                                      const ActiveMethod& course) const {
  auto from = hybrid_.here();
  const std::size_t n = from.q.size();
  std::copy_n(a.numbers.begin(), n, from.q.begin());
  std::copy_n(a.numbers.begin() + n, n, from.p.begin());
  return plain_number(hybrid_.discrete_energy(std::move(from), T(b.t - a.t), course));
}

template class SizedJacobiMaupertuis<SizedJacobiMotion<double>>;
template class SizedJacobiMaupertuis<SizedJacobiMotion<Slope>>;
template class SizedJacobiMaupertuis<MetricJacobiMotion<double>>;
template class SizedJacobiMaupertuis<MetricJacobiMotion<Slope>>;

}  // namespace least
