#include "core/catalogue/sized_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/catalogue/few_scene.hpp"
#include "core/catalogue/sized_adaptive_verlet.hpp"
#include "core/catalogue/sized_tangents.hpp"
#include "core/catalogue/viewed_scene.hpp"
#include "core/number/small_factors.hpp"
#include "core/run/self_timed.hpp"

namespace least {
namespace {

/// ClockedScene is a scene in the form that its integrator needs.
struct ClockedScene {
  const RunBackend* backend;
  const text::SizedScene* scene;

  /// K + V, from which schemes take the level of a run.
  template <class X>
  double level(const X& x) const {
    return backend->table().mechanical_energy(run_state(x));
  }
};

struct ClockedAdaptiveVerlet {
  AdaptiveVerlet chosen;

  static constexpr bool own_clock = true, remembers = true;
  static double level(const ClockedScene& problem, const RunState& x) { return problem.level(x); }
  SizedAdaptiveVerlet bind(const ClockedScene& problem, const RunState& x, double energy) const {
    return {*problem.scene, chosen, x, energy};
  }
};

/// VariedState is a state in dual numbers, as is its time.
struct VariedState {
  using Number = Slope;

  Slope t;
  std::vector<Slope> numbers;
};

/// KernelOnNumbers is the kernel of time_transformed on the problem P of views, for states X of numbers in one
/// contiguous list. If a move fails, the state is undefined.
template <class P, class X>
class KernelOnNumbers {
  using T = typename X::Number;
  using View = ViewedState<T, LinearContact<P>>;
  using Kernel = std::remove_cvref_t<decltype(std::declval<const TimeTransformed&>()
                                                  .bind(std::declval<const P&>(), std::declval<const View&>(),
                                                        std::declval<const T&>())
                                                  .kernel())>;

 public:
  using Memory = typename Kernel::Memory;
  static constexpr bool reads_time = Kernel::reads_time;

  KernelOnNumbers(const TimeTransformed& scheme, const text::SizedScene& scene, X x, const T& energy)
      : coordinates_(scene.coordinates), kernel_(scheme.bind(P(scene), view_of(x), energy).kernel()) {}

  void settle(X x, const Memory& memory) { kernel_.settle(view_of(x), memory); }
  auto memory() const { return kernel_.memory(); }
  auto at(const T& a) const { return kernel_.at(a); }
  T pace(const X&) const { return kernel_.pace(View{}); }
  T strain() const { return kernel_.strain(); }
  int stages() const { return kernel_.stages(); }
  std::string failure() const {
    if constexpr (requires { kernel_.failure(); }) return kernel_.failure();
    return {};
  }

  StepStatus move(X& x, const T& sigma, T& time, Work& work) {
    View y = view_of(x);
    const StepStatus status = kernel_.move(y, sigma, time, work);
    if constexpr (View::acting)
      if (has_action(x)) x.numbers[2 * coordinates_] = y.action.s;
    return status;
  }

 private:
  bool has_action(const X& x) const { return x.numbers.size() > 2 * coordinates_; }
  /// A view of x; if x does not carry s, the view has an s that is ignored.
  View view_of(X& x) const {
    T* const numbers = x.numbers.data();
    View view{T(x.t), {numbers, coordinates_}, {numbers + coordinates_, coordinates_}, {}};
    if constexpr (View::acting)
      if (has_action(x)) view.action.s = numbers[2 * coordinates_];
    return view;
  }

  std::size_t coordinates_;
  Kernel kernel_;
};

/// `scheme` has to outlive the stepper.
template <class P, class X>
auto transformed(const TimeTransformed& scheme, const text::SizedScene& scene, const X& x,
                 const typename X::Number& energy) {
  using Kernel = KernelOnNumbers<P, X>;
  return TransformedStepper<Kernel, X>(Kernel(scheme, scene, x, energy), scheme.sigma);
}

template <class P>
struct ClockedTransformed {
  TimeTransformed chosen;

  static constexpr bool own_clock = true;
  static double level(const ClockedScene& problem, const RunState& x) { return problem.level(x); }
  auto bind(const ClockedScene& problem, const RunState& x, double energy) const {
    return transformed<P>(chosen, *problem.scene, x, energy);
  }
};

/// ClockedFew is a scheme written for problems of fixed type, with N coordinates.
template <int N, class Scheme>
struct ClockedFew {
  Scheme chosen;

  static constexpr bool own_clock = true;
  static double level(const ClockedScene& problem, const State<N>& x) { return problem.level(x); }
  auto bind(const ClockedScene& problem, const State<N>& x, double energy) const {
    FewScene<N> few(*problem.scene);
    if constexpr (std::is_same_v<Scheme, AdaptiveVerlet>)
      few.follow_from(x.q, energy, chosen.unit_energy, problem.backend->motion());
    return chosen.bind(few, x, energy);
  }
};

/// clocked returns the integrator of a scheme on a scene, in states X.
template <class X = RunState, class Scheme>
std::unique_ptr<Integrator> clocked(const RunBackend& backend, const text::SizedScene& scene, const Scheme& scheme,
                                    const RunState& x, double end) {
  const ClockedScene problem{&backend, &scene};
  return std::make_unique<SelfTimedIntegrator<ClockedScene, Scheme, X>>(backend, problem, scheme, state_from<X>(x),
                                                                        end);
}
/// The same for H = K + V(q), with fixed types for few coordinates; `sized` is the scheme for any number of them.
template <class Scheme, class Sized>
std::unique_ptr<Integrator> clocked_by_size(const RunBackend& backend, const text::SizedScene& scene,
                                            const Scheme& scheme, const Sized& sized, const RunState& x, double end) {
  return with_size(scene.coordinates, [&](auto n) {
    if constexpr (std::is_same_v<decltype(n), std::size_t>) {
      return clocked(backend, scene, sized, x, end);
    } else {
      constexpr int few = decltype(n)::value;
      return clocked<State<few>>(backend, scene, ClockedFew<few, Scheme>{scheme}, x, end);
    }
  });
}

/// V at the place of x, which may carry slopes; kinetic_of returns K.
template <class T, class S>
T potential_of(const text::SizedScene& scene, const T* x, const S& t) {
  T v;
  scene.potential.evaluate(x, t, &v);
  return v;
}
template <class T>
T kinetic_of(const text::SizedScene& scene, const T* x) {
  const std::size_t n = scene.coordinates;
  std::vector<T> v(n);
  scene.velocity(x + n, v.data());
  T sum = x[n] * v[0];
  for (std::size_t i = 1; i < n; ++i) sum = sum + x[n + i] * v[i];
  return 0.5 * sum;
}

/// tell writes components and their derivatives to `to`.
void tell(const std::vector<Slope>& all, ChangeOfStep& to) {
  to.to.numbers.resize(all.size());
  to.change.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    to.to[i] = all[i].value;
    to.change[i] = all[i].slope[0];
  }
}

/// TransformedRun holds what the tangents of steps of a run at this level depend on.
struct TransformedRun {
  const text::SizedScene* scene;
  TimeTransformed scheme;
  double level;

  bool step(const RunState& x, const StateNumbers& u, double dt, double slope_of_level, ChangeOfStep& to) const {
    const std::size_t size = scene->components;
    VariedState y{Slope(x.t, {dt}), std::vector<Slope>(size)};
    for (std::size_t i = 0; i < size; ++i) y.numbers[i] = {x[i], {u[i]}};
    auto stepper = transformed<ViewedScene<Slope>>(scheme, *scene, y, Slope(level, {slope_of_level}));
    if (stepper.step(y) != StepStatus::ok) return false;
    to.to.t = y.t.value;
    to.longer = y.t.slope[0] - dt;
    tell(y.numbers, to);
    return true;
  }

  /// Moves z = (q, t; p, p_t; s) by a step; z[i] are its components.
  template <class P>
  bool step_extended(std::vector<Slope>& z) const {
    const std::size_t n = scene->coordinates;
    VariedState x{z[n], {}};
    x.numbers.insert(x.numbers.end(), z.begin(), z.begin() + std::ptrdiff_t(n));
    x.numbers.insert(x.numbers.end(), z.begin() + std::ptrdiff_t(n + 1), z.begin() + std::ptrdiff_t(2 * n + 1));
    x.numbers.push_back(z[2 * n + 2]);
    Slope& p_t = z[2 * n + 1];
    // p_t + H, and from it A.
    const auto potential = [&] { return potential_of(*scene, x.numbers.data(), x.t); };
    const auto off = [&] { return p_t + energy_of(x); };
    const auto gap = [&] { return (std::isnan(scheme.kappa) ? Slope(0) : Slope(level + scheme.kappa)) - potential(); };
    auto stepper = transformed<P>(scheme, *scene, x, Slope(level));
    stepper.resume(x, stepper.kernel().at(gap() + off()));
    if (stepper.step(x) != StepStatus::ok) return false;
    p_t = Slope(0);
    p_t = stepper.memory().a - gap() - off();
    z[n] = x.t;
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = x.numbers[i];
      z[n + 1 + i] = x.numbers[n + i];
    }
    z[2 * n + 2] = x.numbers[2 * n];
    return true;
  }
  Slope energy_of(const VariedState& x) const {
    Slope alpha;
    const Slope* const none = nullptr;
    scene->damping.evaluate(none, x.t, &alpha);
    const Slope* const y = x.numbers.data();
    return kinetic_of(*scene, y) + potential_of(*scene, y, x.t) + alpha * y[2 * scene->coordinates];
  }
};

/// along_all writes the tangent along all directions; `moved(j, to)` is the step from x with a unit change of component
/// j.
template <class Moved>
bool along_all(std::size_t size, const StepTangents::KeepGoing& keep_going, TangentMap& map, Moved&& moved) {
  map.m.resize(size * size);
  for (std::size_t j = 0; j < size; ++j) {
    ChangeOfStep to;
    if (!keep_going() || !moved(j, to)) return false;
    map.to = std::move(to.to);
    for (std::size_t i = 0; i < size; ++i) map.m[i * size + j] = to.change[i];
  }
  return true;
}

template <class P>
bool extended_map(const TransformedRun& run, const RunState& x, const StepTangents::KeepGoing& keep_going,
                  TangentMap& map) {
  const std::size_t n = run.scene->coordinates, size = 2 * n + 3;
  map = {n + 1, {0, StateNumbers(size)}, {}, {}, true};
  VariedState from{Slope(x.t), {x.numbers.begin(), x.numbers.end()}};
  from.numbers.resize(run.scene->components);  // with s, which a run may not carry
  for (std::size_t i = 0; i < n; ++i) {
    map.from[i] = x[i];
    map.from[n + 1 + i] = x[n + i];
  }
  map.from[n] = x.t;
  map.from[2 * n + 1] = -run.energy_of(from).value;
  map.from[2 * n + 2] = from.numbers[2 * n].value;
  return along_all(size, keep_going, map, [&](std::size_t j, ChangeOfStep& to) {
    std::vector<Slope> z(map.from.numbers.begin(), map.from.numbers.end());
    z[j].slope[0] = 1;
    if (!run.step_extended<P>(z)) return false;
    tell(z, to);
    return true;
  });
}

}  // namespace

std::unique_ptr<Integrator> bind_clock(const RunBackend& backend, const text::SizedScene& scene,
                                       const AdaptiveVerlet& scheme, const RunState& x, double end) {
  return clocked_by_size(backend, scene, scheme, ClockedAdaptiveVerlet{scheme}, x, end);
}

std::unique_ptr<Integrator> bind_flat_clock(const RunBackend& backend, const text::SizedScene& scene,
                                            const TimeTransformed& scheme, const RunState& x, double end) {
  if (scene.kind != text::FormKind::contact_linear)
    return clocked_by_size(backend, scene, scheme, ClockedTransformed<ViewedScene<double>>{scheme}, x, end);
  if (scene.constant_damping) return clocked(backend, scene, ClockedTransformed<ViewedDamped<double>>{scheme}, x, end);
  return clocked(backend, scene, ClockedTransformed<ViewedTimedDamped<double>>{scheme}, x, end);
}

StepTangents tangents_of_flat_clock(const text::SizedScene& scene, const TimeTransformed& scheme,
                                    const Request& request) {
  const auto& start = request.scene->initial;
  const std::size_t n = scene.coordinates, size = scene.components;
  const double* const x = start.data();
  const TransformedRun run{&scene, scheme, kinetic_of(scene, x) + potential_of(scene, x, request.scene->start)};
  StepTangents tangents;
  if (!request.until_steps) tangents.end = request.end;
  if (scene.kind == text::FormKind::contact_linear) {
    if (size + 2 > most_mapped) return tangents;
    tangents.extended = [run](const RunState& from, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
      return (run.scene->constant_damping ? extended_map<ViewedDamped<Slope>>
                                          : extended_map<ViewedTimedDamped<Slope>>)(run, from, keep_going, map);
    };
    return tangents;
  }
  tangents.along = [run](const RunState& from, const ActiveMethod&, const StateNumbers& u, double dt, double level,
                         ChangeOfStep& to) { return run.step(from, u, dt, level, to); };
  if (size <= most_mapped)
    tangents.plain = [run, n, size](const RunState& from, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
      map = {n, from, {}, {}};
      return along_all(size, keep_going, map, [&](std::size_t j, ChangeOfStep& to) {
        StateNumbers u(size);
        u[j] = 1;
        return run.step(from, u, 0, 0, to);
      });
    };
  tangents.level.resize(size);
  scene.gradient.evaluate(x, request.scene->start, tangents.level.data());
  scene.velocity(x + n, tangents.level.data() + n);
  return tangents;
}

}  // namespace least
