#include "core/variations/walk_with.hpp"

namespace least::variations {
namespace {

constexpr int most = 64;

/// The same explicit schemes that core/catalogue/sized_backend.cpp offers for scenes of any size.
using Explicit = std::tuple<ExplicitEuler, ExplicitMidpoint, RungeKutta4, SymplecticEuler, Leapfrog, Ruth3,
                            ContactLeapfrog, ContactSplitting, ContactSymplecticEuler, LiftedSplitting>;

template <class V>
std::optional<Walked> walk_among_explicit(const Walk* on, std::string_view id,
                                          const std::shared_ptr<const VariedFormulas>& formulas) {
  return walk_among<V>(on, id, formulas, static_cast<Explicit*>(nullptr));
}

}  // namespace

WalkClass walk_of_large(const text::Form& form) {
  using text::FormKind;
  using Masses = VariedMasses<most>;
  using Full = VariedFullMass<most>;
  const bool full = form.full_mass;
  if (form.kind == FormKind::separable)
    return {full ? walk_among_explicit<VariedSeparable<Full>> : walk_among_explicit<VariedSeparable<Masses>>, most};
  if (form.kind == FormKind::hamiltonian) return {walk_among_explicit<VariedHamiltonian<most>>, most};
  if (form.kind == FormKind::flow) return {walk_among_explicit<VariedFlow<2 * most>>, 2 * most};
  if (form.constant_damping)
    return {full ? walk_among_explicit<VariedDamped<Full>> : walk_among_explicit<VariedDamped<Masses>>, most};
  return {full ? walk_among_explicit<VariedTimedDamped<Full>> : walk_among_explicit<VariedTimedDamped<Masses>>, most};
}

}  // namespace least::variations
