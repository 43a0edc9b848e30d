// The map of kepler_splitting: bodies move about their centre as if they were alone with it, and are kicked by what
// else there is. In Jacobi's coordinates, of each body from the centre of mass of those nearer to the centre, kicks
// depend on places alone. In democratic heliocentric ones, places from the heavy body and momenta from the centre of
// mass, the kinetic energy of the heavy body Σ|P|²/2m₀ is one more part of H: all places jump by h Σ P/m₀.
// Places and velocities are sums that keep what rounding leaves of them, and stay in these coordinates from step to
// step: the state of the scene is made of them, never the other way but at the start.
// Sources: Wisdom & Holman, Astron. J. 102, 1528 (1991); Duncan, Levison & Lee, Astron. J. 116, 2067 (1998); Rein &
// Tamayo, MNRAS 452, 376 (2015).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/schemes/kepler_splitting.hpp"
#include "core/status.hpp"
#include "core/text/planetary.hpp"

namespace least {

/// Kicks and drifts by turns: kick₀, drift₀, kick₁, …, kick_n, in fractions of a step.
struct Turns {
  explicit Turns(const KeplerSplitting& scheme);

  std::vector<double> kick, drift, node;  ///< node: the time of a kick
  /// Jumps go with the drifts, so that a kick at the end of a step and the next one share their forces; else with the
  /// kicks, so that drifts stay exact.
  bool jumps_with_drifts;
};

/// Of numbers T, double or dual. Nothing is allocated in a step.
template <class T>
class PlanetaryStepper {
 public:
  /// `size`: the coordinates of the scene.
  PlanetaryStepper(std::shared_ptr<const text::Planetary> scene, const KeplerSplitting& scheme, std::size_t size);

  /// x: the coordinates of the scene, then their momenta, at the time t. Bodies are ordered by their distances there,
  /// or in `order_from`, another such state: steps of one run have one order, that of its start.
  void begin(const T* x, double t, const T* order_from = nullptr);
  /// From the state at t to that at t + h, which is written to x.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }

 private:
  using Vector = std::array<T, 3>;
  /// A sum, and what rounding has left of it.
  struct Sum {
    Vector high{}, low{};
    void add(const T& c, const Vector& change) noexcept;  ///< c times as much
    void add(const T& c, const Vector& a, const T& d, const Vector& b) noexcept;
  };
  /// From the centre outward; of a centre that is a body the first is the motion of all.
  struct Body {
    std::size_t of;           ///< which one of the scene
    double mass;              ///< its own
    double inside = 0;        ///< the mass of those before
    double reduced = 0;       ///< its mass in these coordinates
    double pull = 0, mu = 0;  ///< k of its orbit, and k by mass
    Sum q, v;
    Vector at{}, speed{}, force{};  ///< in the scene; about a fixed centre places from there
    Vector push{};                  ///< the acceleration of v in a kick
  };

  void set_order(const T* x);
  Vector read(const T* x, const text::Planetary::Body& body) const;
  /// Places, or velocities, in the scene.
  void find_in_scene(Sum Body::*part, Vector Body::*in_scene) noexcept;
  void look(double t) noexcept;
  bool drift(double h) noexcept;
  void kick(double h) noexcept;
  void jump(double h) noexcept;
  void write(T* x) noexcept;

  std::shared_ptr<const text::Planetary> scene_;
  std::shared_ptr<const Turns> turns_;
  bool jacobi_;
  std::size_t size_, first_;        ///< of coordinates; the first body that revolves
  std::vector<Body> bodies_;        ///< in their order
  std::vector<std::size_t> slot_;   ///< of each body of the scene the place in that order
  std::vector<T> places_, slopes_;  ///< for what else there is
  Work work_;
};

extern template class PlanetaryStepper<double>;
extern template class PlanetaryStepper<Dual<double, 1>>;

}  // namespace least
