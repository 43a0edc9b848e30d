#include "core/catalogue/planetary_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/exact/kepler_flow.hpp"
#include "core/number/vector.hpp"
#include "core/schemes/splitting.hpp"

namespace least {
namespace {

using text::Planetary;

/// The vector from one place to another.
template <class T>
std::array<T, 3> way(const std::array<T, 3>& from, const std::array<T, 3>& to) {
  return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}
template <class T>
void add_to(std::array<T, 3>& sum, const T& c, const std::array<T, 3>& a) {
  for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] + c * a[i];
}
/// k/r³ at the distance vector d.
template <class T>
T pull_over_distance(double k, const std::array<T, 3>& d) {
  using least::sqrt;
  const T square = dot(d, d);
  return k / (square * sqrt(square));
}

}  // namespace

Turns::Turns(const KeplerSplitting& scheme) : jumps_with_drifts(scheme.turns() == nullptr) {
  if (const Alternation<double>* turns = scheme.turns()) {
    kick.assign(static_cast<std::size_t>(turns->stages) + 2, 0);
    std::copy_n(turns->kick.begin(), turns->stages, kick.begin() + 1);
    drift.assign(turns->drift.begin(), turns->drift.begin() + turns->stages + 1);
  } else {
    const Leapfrog leapfrog{scheme.step, scheme.composition};
    const auto& sequence = leapfrog.sequence<double>();
    kick.assign(sequence.kick.begin(), sequence.kick.begin() + sequence.drifts + 1);
    drift.assign(sequence.drift.begin(), sequence.drift.begin() + sequence.drifts);
  }
  node.assign(kick.size(), 0);
  for (std::size_t i = 0; i < drift.size(); ++i) node[i + 1] = node[i] + drift[i];
  node.back() = 1;
}

template <class T>
void PlanetaryStepper<T>::Sum::add(const T& c, const Vector& change) noexcept {
  for (std::size_t i = 0; i < 3; ++i) {
    const T more = c * change[i] + low[i], sum = high[i] + more, seen = sum - high[i];
    low[i] = (high[i] - (sum - seen)) + (more - seen);
    high[i] = sum;
  }
}
template <class T>
void PlanetaryStepper<T>::Sum::add(const T& c, const Vector& a, const T& d, const Vector& b) noexcept {
  Vector change;
  for (std::size_t i = 0; i < 3; ++i) change[i] = c * a[i] + d * b[i];
  add(T(1), change);
}

template <class T>
PlanetaryStepper<T>::PlanetaryStepper(std::shared_ptr<const Planetary> scene, const KeplerSplitting& scheme,
                                      std::size_t size)
    : scene_(std::move(scene)),
      turns_(std::make_shared<const Turns>(scheme)),
      jacobi_(scheme.coordinates == KeplerCoordinates::jacobi && scene_->about_body),
      size_(size),
      first_(scene_->about_body ? 1 : 0),
      slot_(scene_->bodies.size()),
      places_(scene_->rest.outputs()),
      slopes_(scene_->rest.outputs()) {
  bodies_.resize(scene_->bodies.size());
}

template <class T>
typename PlanetaryStepper<T>::Vector PlanetaryStepper<T>::read(const T* x, const Planetary::Body& body) const {
  Vector v{};
  for (std::size_t i = 0; i < 3; ++i)
    if (body.coordinates[i] != Planetary::no_axis) v[i] = x[body.coordinates[i]];
  return v;
}

/// set_order orders the bodies from the centre outward.
template <class T>
void PlanetaryStepper<T>::set_order(const T* x) {
  std::vector<std::pair<double, std::size_t>> far;
  far.reserve(bodies_.size());
  const Vector centre = read(x, scene_->bodies.front());
  for (std::size_t i = first_; i < bodies_.size(); ++i) {
    const Vector d = way(centre, read(x, scene_->bodies[i]));
    far.emplace_back(jacobi_ ? plain_number(dot(d, d)) : 0, i);
  }
  std::ranges::stable_sort(far, {}, &std::pair<double, std::size_t>::first);
  double inside = first_ == 1 ? scene_->bodies.front().mass : 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i] = {};
    body.of = i < first_ ? 0 : far[i - first_].second;
    slot_[body.of] = i;
    const Planetary::Body& known = scene_->bodies[body.of];
    body.mass = known.mass;
    if (i < first_) continue;
    body.inside = inside;
    body.reduced = jacobi_ ? known.mass * (inside / (inside + known.mass)) : known.mass;
    body.pull = known.strength;
    inside += known.mass;
  }
  if (jacobi_)
    for (const Planetary::Pair& pair : scene_->pairs)
      bodies_[std::max(slot_[pair.a], slot_[pair.b])].pull += pair.strength;
  for (Body& body : bodies_) body.mu = body.pull / (body.reduced > 0 ? body.reduced : 1);
  if (first_ == 1) bodies_.front().inside = inside;
}

template <class T>
void PlanetaryStepper<T>::begin(const T* x, double t, const T* order_from) {
  work_ = {};
  set_order(order_from ? order_from : x);
  Vector place{}, speed{};  // of the centre of mass of the bodies before
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    const Planetary::Body& known = scene_->bodies[body.of];
    const Vector at = read(x, known), p = read(x + size_, known);
    for (std::size_t k = 0; k < 3; ++k) {
      body.at[k] = at[k];
      const T v = p[k] / body.mass;
      body.v.high[k] = v - speed[k];
      body.q.high[k] = first_ == 0 ? at[k] - scene_->centre[k] : at[k] - place[k];
      if (first_ == 0) continue;
      const double share = body.mass / (i == 0 ? body.mass : body.inside + body.mass);
      speed[k] = speed[k] + share * body.v.high[k];
      place[k] = place[k] + share * body.q.high[k];
    }
  }
  if (first_ == 1) {
    Body& all = bodies_.front();
    if (!jacobi_)
      for (std::size_t i = 1; i < bodies_.size(); ++i) {
        Body& body = bodies_[i];
        body.q.high = way(all.at, body.at);
        const Vector p = read(x + size_, scene_->bodies[body.of]);
        for (std::size_t k = 0; k < 3; ++k) body.v.high[k] = p[k] / body.mass - speed[k];
      }
    all.q.high = place;
    all.v.high = speed;
  }
  if (turns_->kick.front() != 0) look(t);
}

template <class T>
void PlanetaryStepper<T>::find_in_scene(Sum Body::*part, Vector Body::*in_scene) noexcept {
  if (first_ == 0) {
    for (Body& body : bodies_) body.*in_scene = (body.*part).high;
    return;
  }
  Vector middle = (bodies_.front().*part).high;  // of the centre of mass of a body and those before it
  if (jacobi_) {
    for (std::size_t i = bodies_.size(); --i > 0;) {
      Body& body = bodies_[i];
      const Vector& from_middle = (body.*part).high;
      add_to(middle, T(-body.mass / (body.inside + body.mass)), from_middle);
      for (std::size_t k = 0; k < 3; ++k) (body.*in_scene)[k] = middle[k] + from_middle[k];
    }
    bodies_.front().*in_scene = middle;
    return;
  }
  // Positions are relative to the heavy body, velocities to the centre of mass.
  const bool places = part == &Body::q;
  Vector heavy = middle;
  const double mass = places ? bodies_.front().inside : bodies_.front().mass;
  for (std::size_t i = 1; i < bodies_.size(); ++i) add_to(heavy, T(-bodies_[i].mass / mass), (bodies_[i].*part).high);
  const Vector& origin = places ? heavy : middle;
  for (std::size_t i = 1; i < bodies_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) (bodies_[i].*in_scene)[k] = origin[k] + (bodies_[i].*part).high[k];
  bodies_.front().*in_scene = heavy;
}

template <class T>
void PlanetaryStepper<T>::look(double t) noexcept {
  ++work_.forces;
  find_in_scene(&Body::q, &Body::at);
  for (Body& body : bodies_) body.force = {};
  for (const Planetary::Pair& pair : scene_->pairs) {
    Body &a = bodies_[slot_[pair.a]], &b = bodies_[slot_[pair.b]];
    const Vector d = way(a.at, b.at);
    const T w = pull_over_distance(pair.strength, d);
    add_to(a.force, w, d);
    add_to(b.force, T(-w), d);
  }
  if (!slopes_.empty()) {
    for (const Body& body : bodies_)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::size_t i = scene_->bodies[body.of].coordinates[k]; i != Planetary::no_axis)
          places_[i] = first_ == 0 ? scene_->centre[k] + body.at[k] : body.at[k];
    scene_->rest.evaluate(places_.data(), t, slopes_.data());
    for (Body& body : bodies_)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::size_t i = scene_->bodies[body.of].coordinates[k]; i != Planetary::no_axis)
          body.force[k] = body.force[k] - slopes_[i];
  }
  if (first_ == 0) {
    for (Body& body : bodies_)
      for (std::size_t k = 0; k < 3; ++k) body.push[k] = body.force[k] / body.mass;
    return;
  }
  Body& all = bodies_.front();
  if (jacobi_)  // the attraction by the centre, minus that of the Kepler orbits
    for (std::size_t i = 2; i < bodies_.size(); ++i) {
      Body& body = bodies_[i];
      const Vector d = way(body.at, all.at);
      const T w = pull_over_distance(scene_->bodies[body.of].strength, d);
      add_to(body.force, w, d);
      add_to(all.force, T(-w), d);
    }
  Vector sum = all.force;
  for (std::size_t i = 1; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    for (std::size_t k = 0; k < 3; ++k) {
      if (jacobi_) body.push[k] = body.force[k] / body.mass - sum[k] / body.inside;
      sum[k] = sum[k] + body.force[k];
    }
    if (jacobi_ && i > 1) add_to(body.push, pull_over_distance(body.mu, body.q.high), body.q.high);
  }
  for (std::size_t k = 0; k < 3; ++k) all.push[k] = sum[k] / all.inside;
  if (!jacobi_)
    for (std::size_t i = 1; i < bodies_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) bodies_[i].push[k] = bodies_[i].force[k] / bodies_[i].mass - all.push[k];
}

template <class T>
bool PlanetaryStepper<T>::drift(double h) noexcept {
  ++work_.forces;  // counted as one, since it takes as long
  bool good = true;
  if (first_ == 1) bodies_.front().q.add(T(h), bodies_.front().v.high);
  for (std::size_t i = first_; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    const Vector q = body.q.high, v = body.v.high;
    const auto c = two_body::kepler_change(dot(q, q), dot(q, v), dot(v, v), body.mu, h);
    good = good && std::isfinite(plain_number(c.f) + plain_number(c.g) + plain_number(c.df) + plain_number(c.dg));
    body.q.add(c.f, q, c.g, v);
    body.v.add(c.df, q, c.dg, v);
  }
  return good;
}

template <class T>
void PlanetaryStepper<T>::kick(double h) noexcept {
  for (Body& body : bodies_) body.v.add(T(h), body.push);
}

template <class T>
void PlanetaryStepper<T>::jump(double h) noexcept {
  Vector p{};
  for (std::size_t i = 1; i < bodies_.size(); ++i) add_to(p, T(bodies_[i].mass), bodies_[i].v.high);
  for (std::size_t i = 1; i < bodies_.size(); ++i) bodies_[i].q.add(T(h / bodies_.front().mass), p);
}

template <class T>
StepStatus PlanetaryStepper<T>::step(T* x, double t, double h) noexcept {
  const Turns& turns = *turns_;
  const bool jumps = first_ == 1 && !jacobi_;
  const std::size_t last = turns.drift.size();
  if (turns.kick[0] != 0) kick(h * turns.kick[0]);  // the forces are known from the last step or `begin`
  for (std::size_t i = 0; i < last; ++i) {
    const double along = h * turns.drift[i], push = h * turns.kick[i + 1];
    if (jumps && turns.jumps_with_drifts) jump(0.5 * along);
    if (!drift(along)) return StepStatus::singular;
    if (jumps && turns.jumps_with_drifts) jump(0.5 * along);
    if (turns.kick[i + 1] == 0 && i + 1 == last) break;
    if (jumps && !turns.jumps_with_drifts) jump(0.5 * push);
    look(t + h * turns.node[i + 1]);
    kick(push);
    if (jumps && !turns.jumps_with_drifts) jump(0.5 * push);
  }
  write(x);
  return StepStatus::ok;
}

template <class T>
void PlanetaryStepper<T>::write(T* x) noexcept {
  find_in_scene(&Body::q, &Body::at);
  find_in_scene(&Body::v, &Body::speed);
  for (const Body& body : bodies_) {
    const auto& places = scene_->bodies[body.of].coordinates;
    for (std::size_t k = 0; k < 3; ++k) {
      if (places[k] == Planetary::no_axis) continue;
      x[places[k]] = first_ == 0 ? scene_->centre[k] + body.at[k] : body.at[k];
      x[size_ + places[k]] = body.mass * body.speed[k];
    }
  }
}

template class PlanetaryStepper<double>;
template class PlanetaryStepper<Dual<double, 1>>;

}  // namespace least
