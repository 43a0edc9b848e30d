// The map of kepler_splitting: bodies move about their centre on Kepler orbits, and are kicked by all other forces. In
// Jacobi coordinates, of each body relative to the centre of mass of those nearer to the centre, kicks depend on
// positions alone. In democratic heliocentric coordinates, positions from the heavy body and momenta from the centre of
// mass, the kinetic energy of the heavy body Σ|P|²/2m₀ is one more part of H: all positions jump by h Σ P/m₀. Positions
// and velocities are compensated sums, and stay in these coordinates from step to step: the state of the scene is
// computed from them, and they are computed from a state only at the start. Sources: Wisdom & Holman, Astron. J. 102,
// 1528 (1991); Duncan, Levison & Lee, Astron. J. 116, 2067 (1998); Rein & Tamayo, MNRAS 452, 376 (2015).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/schemes/kepler_splitting.hpp"
#include "core/status.hpp"
#include "core/text/planetary.hpp"

namespace least {

/// Turns are the alternating kicks and drifts of a step: kick₀, drift₀, kick₁, …, kick_n, in fractions of a step.
struct Turns {
  explicit Turns(const KeplerSplitting& scheme);

  std::vector<double> kick, drift, node;  ///< node: the time of a kick
  /// Whether jumps go with the drifts, so that a kick at the end of a step and the next one share their forces;
  /// otherwise they go with the kicks, so that drifts stay exact.
  bool jumps_with_drifts;
};

/// T is double or a dual number. A step allocates nothing.
template <class T>
class PlanetaryStepper {
 public:
  /// `size` is the number of coordinates of the scene.
  PlanetaryStepper(std::shared_ptr<const text::Planetary> scene, const KeplerSplitting& scheme, std::size_t size);

  /// x holds the coordinates of the scene, then their momenta, at the time t. Bodies are ordered by their distances in
  /// x, or in `order_from`, another such state: all steps of one run have the order of its start.
  void begin(const T* x, double t, const T* order_from = nullptr);
  /// Steps from the state at t to the state at t + h, which is written to x.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  using Vector = std::array<T, 3>;
  /// Sum is a compensated sum: its value and the rounding error.
  struct Sum {
    Vector high{}, low{};
    void add(const T& c, const Vector& change) noexcept;  ///< adds c·change
    void add(const T& c, const Vector& a, const T& d, const Vector& b) noexcept;
  };
  /// Body is one body, in the order from the centre outward. If the centre is a body, the first one is the motion of
  /// the centre of mass of all.
  struct Body {
    std::size_t of;           ///< index among the bodies of the scene
    double mass;              ///< its own mass
    double inside = 0;        ///< mass of the bodies before it in the order
    double reduced = 0;       ///< reduced mass in these coordinates
    double pull = 0, mu = 0;  ///< strength k of its Kepler potential −k/r, and k/mass
    Sum q, v;
    Vector at{}, speed{}, force{};  ///< in the scene; positions relative to the centre if that is fixed
    Vector push{};                  ///< the acceleration of v in a kick
  };

  void set_order(const T* x);
  Vector read(const T* x, const text::Planetary::Body& body) const;
  /// Computes positions (`part` q), or velocities (`part` v), in the scene.
  void find_in_scene(Sum Body::*part, Vector Body::*in_scene) noexcept;
  void look(double t) noexcept;
  bool drift(double h) noexcept;
  void kick(double h) noexcept;
  void jump(double h) noexcept;
  void write(T* x) noexcept;

  std::shared_ptr<const text::Planetary> scene_;
  std::shared_ptr<const Turns> turns_;
  bool jacobi_;
  std::size_t size_, first_;        ///< number of coordinates; index of the first body that revolves
  std::vector<Body> bodies_;        ///< from the centre outward
  std::vector<std::size_t> slot_;   ///< index in that order of each body of the scene
  std::vector<T> places_, slopes_;  ///< arguments and slopes of the other terms of V
  Work work_;
};

extern template class PlanetaryStepper<double>;
extern template class PlanetaryStepper<Dual<double, 1>>;

}  // namespace least
