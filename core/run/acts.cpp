#include "core/run/acts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/run/tangent_map.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

double number(double x) { return x; }
double number(const Slope& x) { return x.value; }

/// Moving is a state, or with T = Slope a state and its derivative along a direction.
template <class T>
struct Moving {
  T t;
  std::vector<T> x;

  RunState plain() const {
    RunState state{number(t), StateNumbers(x.size())};
    for (std::size_t i = 0; i < x.size(); ++i) state[i] = number(x[i]);
    return state;
  }
};

/// q̇ at a state.
std::vector<double> velocity_at(const RunBackend& backend, const Moving<double>& state) {
  std::vector<double> v(backend.motion().traits.dof);
  backend.velocity(moving_part(backend, state.plain()), v.data());
  return v;
}
std::vector<Slope> velocity_at(const RunBackend& backend, const Moving<Slope>& state) {
  const RunState x = moving_part(backend, state.plain());
  std::vector<double> u(x.size()), v(backend.motion().traits.dof), changes(v);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = state.x[i].slope[0];
  backend.velocity(x, v.data());
  backend.velocity_slopes(x, u.data(), changes.data());
  std::vector<Slope> all(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) all[i] = {v[i], {changes[i]}};
  return all;
}

double energy_at(const RunBackend& backend, const Moving<double>& state) {
  const ProblemTable& problem = backend.table();
  return problem.traits.full && problem.traits.has_energy ? problem.energy_of(state.plain()) : unknown;
}
Slope energy_at(const RunBackend& backend, const Moving<Slope>& state) {
  constexpr double little = 1e-6;
  const auto moved = [&](double by) {
    RunState x = state.plain();
    x.t += by * state.t.slope[0];
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += by * state.x[i].slope[0];
    const ProblemTable& problem = backend.table();
    return problem.traits.full && problem.traits.has_energy ? problem.energy_of(x) : unknown;
  };
  return {moved(0), {(moved(little) - moved(-little)) / (2 * little)}};
}

/// observed_by returns the arguments of the expressions of an act: the variables, the energy, and the velocities if
/// there are any.
template <class T>
std::vector<T> observed_by(const RunBackend& backend, const Scene& scene, const Measures& measures,
                           const Moving<T>& state, bool velocities) {
  std::vector<T> all(scene.card().variables.size() + 1, T(unknown));
  for (std::size_t i = 0; i < std::min(state.x.size(), all.size() - 1); ++i) all[i] = state.x[i];
  if (measures.reads_energy()) all.back() = energy_at(backend, state);
  if (velocities) {
    const std::vector<T> v = velocity_at(backend, state);
    all.insert(all.end(), v.begin(), v.end());
  }
  return all;
}

template <class T>
Moving<T> made_of(const RunBackend& backend, const Scene& scene, const Act& act, const Moving<T>& before) {
  const text::TextScene* const text = scene.mechanics->text();
  const bool velocities = text && text->takes_velocities();
  std::vector<T> values(act.settings.size());
  act.values.evaluate(observed_by(backend, scene, act.values, before, velocities).data(), before.t, values.data());
  Moving<T> after = before;
  const bool sets_velocities = std::ranges::any_of(act.settings, &Setting::velocity);
  std::vector<T> v;
  if (sets_velocities) v = velocity_at(backend, before);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Setting& set = act.settings[i];
    const bool turned = text && (set.velocity ? text->forward != nullptr : text->turns(set.index));
    (set.velocity ? v : after.x)[set.index] = turned ? -values[i] : values[i];
  }
  if (!sets_velocities) return after;
  std::vector<T> state(scene.card().variables.size(), T(0));
  std::copy_n(after.x.begin(), std::min(after.x.size(), state.size()), state.begin());
  const auto capacity = static_cast<std::size_t>(text->capacity), n = text->form->coordinates;
  std::copy_n(v.begin(), n, state.begin() + static_cast<std::ptrdiff_t>(capacity));
  text->velocities_to_momenta(scene.parameters, before.t, state);
  std::copy_n(state.begin() + static_cast<std::ptrdiff_t>(capacity), n,
              after.x.begin() + static_cast<std::ptrdiff_t>(capacity));
  return after;
}

Moving<double> moving(const RunState& x) { return {x.t, {x.numbers.begin(), x.numbers.end()}}; }
Moving<Slope> along(const RunState& x, const double* u, double dt) {
  Moving<Slope> state{{x.t, {dt}}, {}};
  for (std::size_t i = 0; i < x.size(); ++i) state.x.push_back({x[i], {u[i]}});
  return state;
}

}  // namespace

Acts::Acts(const RunBackend& backend, const Request& request)
    : backend_(backend), request_(request), done_(request.events.size()) {
  any_ = std::ranges::any_of(request.events, [](const EventAsked& event) { return event.act != nullptr; });
}

Acts::Effect Acts::act(std::size_t event, RunState& x) {
  const Act& act = *request_.events[event].act;
  const RunState before = x;
  const Moving<double> after = made_of(backend_, *request_.scene, act, moving(before));
  if (!std::ranges::all_of(after.x, [](double component) { return std::isfinite(component); }))
    return Effect::not_finite;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = after.x[i];
  Done& done = done_[event];
  constexpr std::int64_t looked_at = 16;
  constexpr std::size_t largest = 128;
  if (done.count < looked_at) {
    const double defect = x.size() <= largest ? defect_of(event, before, x) : unknown;
    if (!(defect <= done.defect)) done.defect = defect;  // NaN stays NaN
  }
  ++done.count;
  constexpr std::ptrdiff_t times_kept = 3 * 4096 + 1;  // three strides of the longest sequence that is recognised
  if (std::ssize(done.times) == 2 * times_kept) done.times.erase(done.times.begin(), done.times.end() - times_kept);
  done.times.push_back(x.t);
  if (done.count == act.most) return Effect::completes;
  if (comes_to_rest(event, before, x)) return Effect::rests;
  return has_piled_up(event, x) ? Effect::piles_up : Effect::goes_on;
}

std::vector<double> Acts::rates_at(const RunState& x) const {
  std::vector<double> rates(std::max(x.size(), backend_.table().traits.components));
  backend_.table().rates(x, rates.data());
  return rates;
}

double Acts::rate_of(std::size_t event, const RunState& x) const {
  std::vector<Slope> changes(request_.watched.size());
  const Moving<Slope> moves = along(x, rates_at(x).data(), 1);
  request_.watched.evaluate(observed_by(backend_, *request_.scene, request_.watched, moves, false).data(), moves.t,
                            changes.data());
  return changes[event].slope[0];
}

double Acts::value_of(std::size_t event, const RunState& x) const {
  std::vector<double> values(request_.watched.size());
  const Moving<double> state = moving(x);
  request_.watched.evaluate(observed_by(backend_, *request_.scene, request_.watched, state, false).data(), state.t,
                            values.data());
  return values[event];
}

bool Acts::comes_to_rest(std::size_t event, const RunState& before, const RunState& after) {
  constexpr double nothing = 1e-9, rounding = 64;
  Done& done = done_[event];
  const double arrived = rate_of(event, before), left = rate_of(event, after), last = std::exchange(done.rate, left);
  const double size = std::fmax(std::abs(arrived), std::abs(last));
  if (!(std::abs(left) <= nothing * size)) return false;
  // A state that was moved away from the zero has some way to go before the event happens again.
  if (!(std::abs(value_of(event, after)) <= std::abs(value_of(event, before)) + rounding * rounding_of(event, after)))
    return false;
  // A state that arrives without speed, as after a scheme took a short bounce in one step, comes from the side to which
  // the last act sent it.
  double onward = request_.events[event].direction;
  if (onward == 0) onward = std::abs(arrived) > nothing * size ? arrived : -last;
  const double little = 1e-6 * (after.t - request_.scene->start);
  RunState later = after;
  const std::vector<double> rates = rates_at(after);
  for (std::size_t i = 0; i < later.size(); ++i) later[i] += little * rates[i];
  later.t += little;
  if (!((rate_of(event, later) - left) * onward > 0)) return false;
  limit_ = after.t;
  return true;
}

/// has_piled_up returns whether the intervals between the last times of an event shrink like a geometric sequence and
/// the next one is lost in the rounding of the time, or of the state. A sequence that has not come so far may still
/// turn, as of a ball that is thrown again once it is slow: it goes on. Intervals that shrink slowly are compared over
/// strides of many events, so that their ratio stands out from the rounding; where it tends to 1 they have a limit of
/// their own.
bool Acts::has_piled_up(std::size_t event, const RunState& after) {
  constexpr double shorter = 0.75, alike = 0.05, lost = 4, resolved = 1024, given_back = 8;
  const std::vector<double>& times = done_[event].times;
  if (times.size() < 4) return false;
  // The time of the event before the last one is at(1).
  const auto at = [&times](std::size_t back) { return times[times.size() - 1 - back]; };
  const double unit =
      std::numeric_limits<double>::epsilon() * std::fmax(std::abs(at(0)), std::abs(request_.scene->start));
  limit_ = at(0);
  if (at(0) - at(3) <= lost * unit) return true;
  for (std::size_t stride = 1; 3 * stride < times.size(); stride *= 2) {
    const double last = at(0) - at(stride), one = at(stride) - at(2 * stride), other = at(2 * stride) - at(3 * stride);
    const double ratio = last / one;
    if (!(ratio < shorter && std::abs(ratio - one / other) < alike)) continue;
    const double each = std::pow(ratio, 1 / static_cast<double>(stride)), next = (at(0) - at(1)) * each;
    // Rounding of the state may give back what an act takes away once that is only a few units.
    const bool hidden = next < std::fmax(resolved, given_back / (1 - each)) * rounding_in_time(event, after);
    if (!(next < resolved * unit || hidden)) return false;
    limit_ = at(0) + last * ratio / (1 - ratio);
    return true;
  }
  return false;
}

double Acts::rounding_of(std::size_t event, const RunState& x) const {
  constexpr double round_off = std::numeric_limits<double>::epsilon();
  const Scene& scene = *request_.scene;
  const Measures& watched = request_.watched;
  const Moving<double> state = moving(x);
  const std::vector<double> observed = observed_by(backend_, scene, watched, state, false);
  std::vector<interval::Enclosure> bounds(observed.size());
  std::ranges::transform(observed, bounds.begin(), [](double y) {
    return interval::Enclosure{y - round_off * std::abs(y), y + round_off * std::abs(y)};
  });
  std::vector<interval::Enclosure> values(watched.size());
  watched.enclose(bounds.data(), x.t, values.data());
  return values[event].width();
}

double Acts::rounding_in_time(std::size_t event, const RunState& x) const {
  const double rate = std::abs(rate_of(event, x));
  return rate > 0 ? rounding_of(event, x) / rate : 0;  // a motion left at rest begins anew
}

double Acts::defect_of(std::size_t event, const RunState& before, const RunState& after) const {
  const ProblemTraits& traits = backend_.table().traits;
  const bool keeps_form = (traits.potential || traits.general) && !traits.forced;
  if (!keeps_form || traits.sloped) return unknown;
  const std::size_t size = traits.components;
  const Scene& scene = *request_.scene;
  const Act& act = *request_.events[event].act;
  std::vector<double> from(size), to(size), zero(size, 0);
  backend_.table().rates(before, from.data());
  backend_.table().rates(after, to.data());
  std::vector<Slope> values(request_.watched.size());
  // Derivatives along (u, dt): writes that of g to `made`, and returns that of the expression.
  const auto change = [&](const double* u, double dt, std::vector<double>& made) {
    const Moving<Slope> state = along(before, u, dt);
    const Moving<Slope> image = made_of(backend_, scene, act, state);
    for (std::size_t i = 0; i < size; ++i) made[i] = image.x[i].slope[0];
    request_.watched.evaluate(observed_by(backend_, scene, request_.watched, state, false).data(), state.t,
                              values.data());
    return values[event].slope[0];
  };
  std::vector<double> in_time(size), jump(size), column(size);
  const double passing = change(from.data(), 1, jump);  // along the motion: hᵀf₋ + h_t, and `jump` = G f₋ + g_t
  for (std::size_t i = 0; i < size; ++i) jump[i] = to[i] - jump[i];
  TangentMap map;
  map.dof = traits.dof;
  map.from = before;
  map.to = after;
  map.m.resize(size * size);
  std::vector<double> u(size, 0);
  for (std::size_t j = 0; j < size; ++j) {
    u[j] = 1;
    const double slope = change(u.data(), 0, column) / passing;
    u[j] = 0;
    for (std::size_t i = 0; i < size; ++i) map.m[i * size + j] = column[i] + jump[i] * slope;
  }
  return traits.acting ? contact_defect(map).defect : symplectic_defect(map);
}

std::vector<Report> Acts::reports() const {
  constexpr double rounding = 1e-9;
  std::vector<Report> all;
  const ProblemTraits& traits = backend_.table().traits;
  for (std::size_t i = 0; i < done_.size(); ++i) {
    const Done& done = done_[i];
    if (done.count == 0) continue;
    const bool mechanics = traits.potential || traits.general, known = std::isfinite(done.defect);
    const std::string_view kept = known && done.defect < rounding ? (traits.acting ? "contact" : "symplectic") : "none";
    all.push_back({"", std::vector<Report>{words("name", request_.watched.list[i].card.name),
                                           {"count", static_cast<double>(done.count)},
                                           words("keeps", mechanics && !known ? "" : kept),
                                           {"defect", done.defect}}});
  }
  return all;
}

}  // namespace least
