#include "core/periodic/bifurcations.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace least::periodic {
namespace {

using Complex = std::complex<double>;

bool keeps_pairs(const Stability& of) { return of.pair_product == 1; }
std::span<const Multiplier> others_of(const Stability& of) {
  return std::span(of.multipliers).subspan(std::min(of.trivial(), of.multipliers.size()));
}

}  // namespace

double Crossings::of(Bifurcation kind) const {
  if (kind == Bifurcation::period_doubling) return doubling;
  return kind == Bifurcation::torus ? torus : branching;
}

Crossings crossings_of(const Stability& stability) {
  Complex doubling = 1, branching = 1;
  double largest_pair = 0;
  for (const auto& [value, kind, error] : others_of(stability)) {
    doubling *= value + 1.0;
    branching *= value - 1.0;
    if (std::abs(value.imag()) > 1e-9) largest_pair = std::max(largest_pair, std::abs(value));
  }
  const double left = largest_pair > 1 + 1e-6 ? 1 : -1, apart = largest_pair > 0 ? largest_pair - 1 : 0;
  return {doubling.real(), branching.real(), keeps_pairs(stability) ? left : apart};
}

double multipliers_away_from(Bifurcation kind, const Stability& stability) {
  const std::span others = others_of(stability);
  const auto turns = [](const Complex& value) { return value.imag() > 1e-9; };  // one of each complex pair
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < others.size(); ++i) {
    const Complex& value = others[i].value;
    if (kind == Bifurcation::period_doubling) nearest = std::min(nearest, std::abs(value + 1.0));
    if (kind == Bifurcation::pitchfork_or_transcritical) nearest = std::min(nearest, std::abs(value - 1.0));
    if (kind != Bifurcation::torus || !turns(value)) continue;
    if (!keeps_pairs(stability)) nearest = std::min(nearest, std::abs(std::abs(value) - 1));
    // Two pairs about to collide differ by the square root of the distance from the collision, hence norm (|·|²).
    for (std::size_t k = 0; k < i && keeps_pairs(stability); ++k)
      if (turns(others[k].value)) nearest = std::min(nearest, std::norm(value - others[k].value));
  }
  return nearest;
}

std::optional<bool> stable_at(Bifurcation kind, const Stability& stability) {
  constexpr double at_one = 1e-7;
  const std::span all = others_of(stability);
  std::vector<Multiplier> others(all.begin(), all.end());
  const auto away = [kind](const Multiplier& one) {
    if (kind == Bifurcation::torus) return std::abs(std::abs(one.value) - 1);
    return std::abs(one.value + (kind == Bifurcation::period_doubling ? 1.0 : -1.0));
  };
  std::ranges::sort(others, {}, away);
  const std::size_t at_it = (kind == Bifurcation::torus ? 2U : 1U) * (keeps_pairs(stability) ? 2U : 1U);
  for (std::size_t i = at_it; i < others.size(); ++i)
    if (std::abs(others[i].value) > 1 + std::max(at_one, others[i].error)) return false;
  return std::nullopt;
}

}  // namespace least::periodic
