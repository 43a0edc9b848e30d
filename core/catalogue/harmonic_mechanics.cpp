// harmonic_splitting on scenes as text.
#include "core/catalogue/found_steps.hpp"
#include "core/schemes/harmonic_stepper.hpp"

namespace least {
namespace {

struct Oscillators {
  using Scheme = HarmonicSplitting;
  using What = text::Harmonic;
  template <class T>
  using Stepper = HarmonicStepper<T>;

  static auto look(const text::TextScene& scene, std::span<const double> parameters) {
    return text::harmonic(*scene.form, parameters);
  }
};

}  // namespace

FoundScheme harmonic_splitting_found() { return {"harmonic_splitting", concerns_texts, look_for<Oscillators>}; }

}  // namespace least
