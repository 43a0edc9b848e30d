// Conditions under which schemes run a scene whose size is known only at run time.
#pragma once

#include "core/text/sized_scene.hpp"

namespace least {

/// on_a_metric: the kinetic metric depends on q, without forces.
inline bool on_a_metric(const text::SizedScene& scene) { return scene.kind == text::FormKind::metric && !scene.forced; }

/// is_flat: the metric is constant, without forces; H is separable, or linear in s.
inline bool is_flat(const text::SizedScene& scene) {
  const bool flat = scene.kind == text::FormKind::separable || scene.kind == text::FormKind::contact_linear;
  return flat && !scene.forced;
}

/// on_damped_metric: friction α(t) s with a metric that depends on q: a general H whose motion of (q, p) does not
/// depend on s.
inline bool on_damped_metric(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::hamiltonian && !scene.forced && scene.moving < scene.components;
}

/// follows_herglotz: steps are made of the Lagrangian (core/catalogue/sized_herglotz.hpp).
inline bool follows_herglotz(const text::SizedScene& scene) {
  return scene.is_quadratic() || scene.velocities || on_a_metric(scene) || on_damped_metric(scene);
}

inline bool on_all(const text::SizedScene&) { return true; }
/// with_series: the equations of motion can be written out, as series need all terms of a sum.
inline bool with_series(const text::SizedScene& scene) { return scene.plain().has_value(); }
/// on_separable: H is separable; forces may be such that a kick can solve for the momenta.
inline bool on_separable(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::separable && (!scene.forced || scene.forces.solvable());
}
/// with_exact_kicks: for schemes of order 3, since the errors of symmetric but inexact kicks would not cancel.
inline bool with_exact_kicks(const text::SizedScene& scene) {
  return on_separable(scene) && (!scene.forced || scene.forces.linear);
}
/// on_steady: H is separable and autonomous, without forces.
inline bool on_steady(const text::SizedScene& scene) {
  return scene.kind == text::FormKind::separable && !scene.forced && scene.autonomous;
}
inline bool with_lift(const text::SizedScene& scene) { return scene.lift != nullptr; }
inline bool on_damped(const text::SizedScene& scene) { return scene.kind == text::FormKind::contact_linear; }
inline bool on_contact(const text::SizedScene& scene) { return on_damped(scene) || scene.is_quadratic(); }
/// with_lagrangian: scenes with s that are stepped by their Lagrangian, of at most most_full coordinates.
inline bool with_lagrangian(const text::SizedScene& scene) {
  return (scene.is_quadratic() || scene.velocities || on_damped_metric(scene)) &&
         scene.coordinates <= text::SizedScene::most_full;
}
inline bool on_steady_or_damped(const text::SizedScene& scene) { return on_steady(scene) || on_damped(scene); }
inline bool on_contact_path(const text::SizedScene& scene) {
  return on_damped(scene) ? scene.solves_for_places() : with_lagrangian(scene);
}
/// with_path: separable scenes with a matrix that is not too large to solve for places; forced scenes and those whose
/// metric depends on q, of at most most_full coordinates.
inline bool with_path(const text::SizedScene& scene) {
  if (is_flat(scene)) return scene.kind == text::FormKind::separable && scene.solves_for_places();
  return (scene.forced || scene.kind == text::FormKind::metric) && scene.coordinates <= text::SizedScene::most_full;
}
/// with_level: for steps whose length is chosen by the energy.
inline bool with_level(const text::SizedScene& scene) {
  return (is_flat(scene) || on_a_metric(scene)) && with_path(scene) && scene.autonomous;
}
/// with_parameter: for time_transformed, which is explicit if the metric is constant; damped scenes as well.
inline bool with_parameter(const text::SizedScene& scene) {
  return on_steady_or_damped(scene) || (on_a_metric(scene) && with_level(scene));
}
inline bool with_gauss(const text::SizedScene& scene) {
  if (is_flat(scene)) return on_contact_path(scene);
  const bool general = scene.kind == text::FormKind::hamiltonian && !scene.forced;
  return (general || with_lagrangian(scene)) && scene.coordinates <= text::SizedScene::most_full;
}

}  // namespace least
