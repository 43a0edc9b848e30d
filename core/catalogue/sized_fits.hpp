// On which scenes the schemes of scenes whose size is known when they run go: what each needs of the mechanics.
#pragma once

#include "core/text/sized_scene.hpp"

namespace least {

/// Whether steps are made of a metric that depends on the place.
inline bool on_a_metric(const text::SizedScene& scene) { return scene.kind == text::FormKind::metric && !scene.forced; }

/// Where the middle of a step says all of it.
inline bool is_flat(const text::SizedScene& scene) {
  const bool flat = scene.kind == text::FormKind::separable || scene.kind == text::FormKind::contact_linear;
  return flat && !scene.forced;
}

/// With friction α(t) s on a metric that depends on the place: a general H whose q and p move without s.
inline bool on_damped_metric(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::hamiltonian && !scene.forced && scene.moving < scene.components;
}

/// By its Lagrangian.
inline bool follows_herglotz(const text::SizedScene& scene) {
  return scene.is_quadratic() || scene.velocities || on_a_metric(scene) || on_damped_metric(scene);
}

inline bool on_all(const text::SizedScene&) { return true; }
/// Series are made of the operations of all terms of a sum.
inline bool with_series(const text::SizedScene& scene) { return scene.plain().has_value(); }
/// With forces that momenta can be solved for.
inline bool on_separable(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::separable && (!scene.forced || scene.forces.solvable());
}
/// Of order 3 with exact kicks alone: a symmetric error in each would not cancel.
inline bool with_exact_kicks(const text::SizedScene& scene) {
  return on_separable(scene) && (!scene.forced || scene.forces.linear);
}
/// Where nothing depends on time.
inline bool on_steady(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::separable && !scene.forced && scene.autonomous;
}
inline bool with_lift(const text::SizedScene& scene) { return scene.lift != nullptr; }
inline bool on_damped(const text::SizedScene& scene) { return scene.kind == text::FormKind::contact_linear; }
inline bool on_contact(const text::SizedScene& scene) { return on_damped(scene) || scene.is_quadratic(); }
/// Of not too many coordinates, with s that acts by its Lagrangian.
inline bool with_lagrangian(const text::SizedScene& scene) {
  return (scene.is_quadratic() || scene.velocities || on_damped_metric(scene)) &&
         scene.coordinates <= text::SizedScene::most_full;
}
inline bool on_steady_or_damped(const text::SizedScene& scene) { return on_steady(scene) || on_damped(scene); }
inline bool on_contact_path(const text::SizedScene& scene) {
  return on_damped(scene) ? scene.solves_for_places() : with_lagrangian(scene);
}
/// Forced ones, and those whose metric depends on the place, where a step's matrix is not too large.
inline bool with_path(const text::SizedScene& scene) {
  if (is_flat(scene)) return scene.kind == text::FormKind::separable && scene.solves_for_places();
  return (scene.forced || scene.kind == text::FormKind::metric) && scene.coordinates <= text::SizedScene::most_full;
}
/// Of steps whose length is chosen by the energy.
inline bool with_level(const text::SizedScene& scene) {
  return (is_flat(scene) || on_a_metric(scene)) && with_path(scene) && scene.autonomous;
}
/// The same, explicit where the metric is constant; or damped.
inline bool with_parameter(const text::SizedScene& scene) {
  return on_steady_or_damped(scene) || (on_a_metric(scene) && with_level(scene));
}
inline bool with_gauss(const text::SizedScene& scene) {
  if (is_flat(scene)) return on_contact_path(scene);
  const bool general = scene.kind == text::FormKind::hamiltonian && !scene.forced;
  return (general || with_lagrangian(scene)) && scene.coordinates <= text::SizedScene::most_full;
}

}  // namespace least
