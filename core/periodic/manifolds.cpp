// Stable and unstable manifolds of a closed orbit: trajectories begin at places along the orbit, slightly off in the
// direction of the fastest growth, and run forward for the unstable manifold and backward for the stable one, whose
// direction grows backward.
// direction grows. Source: Parker & Chua, Practical Numerical Algorithms for Chaotic Systems, 1989, 6.2.
#include <algorithm>
#include <cmath>

#include "core/catalogue/backward.hpp"
#include "core/periodic/orbits.hpp"

namespace least::periodic {
namespace {

constexpr double offset = 1e-6;  // distance of starts from the orbit, in units of its extents

/// turned_around returns the orbit as a trial of the time-reversed scene, from the same place.
Trial turned_around(const Trial& trial, const variations::ParametricScene& equations, std::vector<double> turns) {
  Trial made{{}, {}, trial.period, trial.value};
  const std::size_t count = trial.nodes.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = (count - k) % count;
    std::vector<double> node = trial.nodes[i];
    for (std::size_t a = 0; a < node.size(); ++a) node[a] = equations.signs[a] * (node[a] - (k > 0 ? turns[a] : 0));
    made.nodes.push_back(std::move(node));
    made.at.push_back(k == 0 ? 0 : 1 - trial.at[i]);
  }
  return made;
}

/// refine_for_the_way_back inserts nodes into a forward orbit where differences of the backward motion grow too much in
/// a segment: a strongly attracting orbit can be followed backward over short parts only. False: too many nodes are
/// needed.
bool refine_for_the_way_back(Trial& trial, const Setting& setting, Motion& forward, Motion& back, double start,
                             Effort& effort) {
  constexpr double most_of_one = 3e3, wanted = 300;
  constexpr int rounds = 12;
  constexpr std::size_t most_nodes = 128;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t count = trial.nodes.size();
    const Trial turned = turned_around(trial, back.equations(), setting.turns);
    Trial finer{{}, {}, trial.period, trial.value};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = count - 1 - i;  // the same segment in the reversed order
      const double from = trial.at[i], to = i + 1 < count ? trial.at[i + 1] : 1;
      std::string reason;
      const auto reached =
          back.follow(turned.nodes[k], start + turned.at[k] * trial.period, (to - from) * trial.period, effort, reason);
      if (effort.over()) return false;
      double growth = wanted * wanted;
      if (reached) {
        growth = 0;
        for (std::size_t a = 0; a < reached->by_start.rows; ++a)
          for (std::size_t b = 0; b < reached->by_start.columns; ++b)
            growth = std::max(growth, std::abs(reached->by_start(a, b)) * setting.extents[b] / setting.extents[a]);
      }
      const auto parts = growth <= most_of_one
                             ? std::size_t(1)
                             : static_cast<std::size_t>(std::ceil(std::log(growth) / std::log(wanted)));
      std::vector<double> times;
      for (std::size_t part = 0; part < parts; ++part) {
        finer.at.push_back(from + (to - from) * double(part) / double(parts));
        times.push_back(setting.start() + finer.at.back() * trial.period);
      }
      const auto states = forward.path(trial.nodes[i], times[0], times, effort, reason);
      if (states.size() < parts) return false;
      finer.nodes.insert(finer.nodes.end(), states.begin(), states.end());
    }
    if (finer.nodes.size() == count) return true;
    if (finer.nodes.size() > most_nodes) return false;
    trial = std::move(finer);
  }
  return false;
}

class Growing {
 public:
  Growing(const Question& question, const Setting& setting, Motion& motion, double start, Effort& effort)
      : question_(question), setting_(setting), motion_(motion), start_(start), effort_(effort) {}

  Manifold of(const Trial& orbit) {
    Manifold made;
    const std::size_t n = motion_.size(), count = orbit.nodes.size();
    Matrix all = Matrix::identity(n);
    std::vector<Matrix> segments;
    for (std::size_t i = 0; i < count; ++i) {
      const double from = orbit.at[i], to = i + 1 < count ? orbit.at[i + 1] : 1;
      auto reached = motion_.follow(orbit.nodes[i], start_ + from * orbit.period, (to - from) * orbit.period, effort_,
                                    made.reason);
      if (!reached) return made;
      segments.push_back(in_units(reached->by_start));
      all = segments.back() * all;
    }
    constexpr double surely = 1e-4, rounding = 1e-13;
    const double size = length(all.a);
    if (!std::isfinite(size)) {
      made.reason = "differences of the motion grow beyond any number over a period";
      return made;
    }
    for (const auto& value : eigenvalues(all))
      if (std::abs(value.imag()) <= 1e-12 * std::abs(value) && std::abs(value) > 1 + surely &&
          std::abs(value) > rounding * size && !(std::abs(value.real()) <= std::abs(made.multiplier)))
        made.multiplier = value.real();
    if (std::isnan(made.multiplier)) {
      made.reason = "no multiplier is real and on that side of the unit circle";
      return made;
    }
    std::vector<double> way = eigenvector(all, made.multiplier);
    const int wanted = question_.manifolds->count;
    for (std::size_t i = 0, k = 0; i < count && !effort_.over(); ++i) {
      const double next = i + 1 < count ? orbit.at[i + 1] : 1;
      for (; k < std::size_t(wanted) && double(k) / wanted < next; ++k) {
        const double at = double(k) / wanted;
        const auto here = motion_at(orbit, i, at, way, made.reason);
        if (!here) return made;
        for (const int side : {1, -1})
          made.curves.push_back(curve(here->first, here->second, side, start_ + at * orbit.period));
      }
      way = unit(segments[i] * way);
    }
    return made;
  }

 private:
  Matrix in_units(Matrix slopes) const {
    for (std::size_t a = 0; a < slopes.rows; ++a)
      for (std::size_t b = 0; b < slopes.columns; ++b) slopes(a, b) *= setting_.extents[b] / setting_.extents[a];
    return slopes;
  }
  static std::vector<double> unit(std::vector<double> way) {
    const double size = length(way);
    for (double& part : way) part /= size;
    return way;
  }

  /// motion_at returns the state, and the transported direction, at the fraction `at` of the period behind a node.
  std::optional<std::pair<std::vector<double>, std::vector<double>>> motion_at(const Trial& orbit, std::size_t node,
                                                                               double at,
                                                                               const std::vector<double>& way,
                                                                               std::string& reason) {
    const double dt = (at - orbit.at[node]) * orbit.period;
    if (!(dt > 0)) return std::pair(orbit.nodes[node], way);
    const auto reached = motion_.follow(orbit.nodes[node], start_ + orbit.at[node] * orbit.period, dt, effort_, reason);
    if (!reached) return std::nullopt;
    return std::pair(reached->state, unit(in_units(reached->by_start) * way));
  }

  /// curve follows a trajectory as far as possible.
  Manifold::Curve curve(std::vector<double> x, const std::vector<double>& way, int side, double t) {
    const std::int64_t samples = samples_of_a_curve(question_, motion_.size());
    Manifold::Curve made;
    made.side = side;
    for (std::size_t a = 0; a < x.size(); ++a) x[a] += side * offset * setting_.extents[a] * way[a];
    made.t.push_back(t);
    for (std::int64_t k = 1; k < samples; ++k)
      made.t.push_back(t + question_.manifolds->until * double(k) / double(samples - 1));
    std::string reason;
    made.states = motion_.path(x, t, std::span(made.t).subspan(1), effort_, reason);
    made.states.insert(made.states.begin(), std::move(x));
    made.t.resize(made.states.size());
    const variations::ParametricScene& equations = motion_.equations();
    for (double& time : made.t) time = equations.sign_of_time() * time + 0.0;  // + 0.0 turns −0 into 0
    for (auto& state : made.states)
      for (std::size_t a = 0; a < state.size(); ++a) state[a] = equations.signs[a] * state[a] + 0.0;
    return made;
  }

  const Question& question_;
  const Setting& setting_;
  Motion& motion_;
  double start_;
  Effort& effort_;
};

}  // namespace

std::int64_t samples_of_a_curve(const Question& question, std::size_t components) {
  constexpr std::int64_t most = 200;
  const std::int64_t curves = 4 * question.manifolds->count;
  return std::clamp<std::int64_t>(question.limits.samples / (curves * static_cast<std::int64_t>(components + 1)), 2,
                                  most);
}

std::size_t bytes_of_manifolds(const Question& question, std::size_t components) {
  const std::int64_t states = 4 * question.manifolds->count * samples_of_a_curve(question, components);
  return static_cast<std::size_t>(states) * ((components + 1) * sizeof(double) + sizeof(std::vector<double>));
}

std::vector<Manifold> manifolds_of(const Question& question, const Setting& setting, Motion& forward,
                                   const Trial& closed, Effort& effort) {
  std::vector<Manifold> both;
  both.push_back(Growing(question, setting, forward, setting.start(), effort).of(closed));
  Manifold& stable = both.emplace_back();
  stable.stable = true;
  const auto turned = backward(*setting.scene);
  if (const auto* why = std::get_if<std::string>(&turned)) {
    stable.reason = *why;
    return both;
  }
  const Scene& scene = std::get<Scene>(turned);
  auto equations = equations_of(scene, {});
  if (const auto* why = std::get_if<std::string>(&equations)) {
    stable.reason = *why;
    return both;
  }
  Motion back(std::get<Motion::Equations>(equations), {}, setting.tolerance);
  Trial finer = closed;
  if (!refine_for_the_way_back(finer, setting, forward, back, scene.start, effort)) {
    stable.reason = effort.over() ? effort.why() : "backward, differences of the motion grow too fast to be followed";
    return both;
  }
  const Trial orbit = turned_around(finer, back.equations(), setting.turns);
  stable = Growing(question, setting, back, scene.start, effort).of(orbit);
  stable.stable = true;
  stable.multiplier = 1 / stable.multiplier;
  return both;
}

}  // namespace least::periodic
