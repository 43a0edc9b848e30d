#include "core/catalogue/roomy_tangents.hpp"

#include <algorithm>
#include <utility>

namespace least {
namespace {

/// On the extended space (q, t; p, p_t; s).
std::vector<std::size_t> extended_places_in(std::size_t n, std::size_t room) {
  std::vector<std::size_t> places;
  for (const std::size_t from : {std::size_t(0), room + 1}) {
    for (std::size_t i = 0; i < n; ++i) places.push_back(from + i);
    places.push_back(from + room);
  }
  places.push_back(2 * room + 2);
  return places;
}

void spread(const double* few, const std::vector<std::size_t>& places, std::size_t count, StateNumbers& many) {
  std::fill(many.begin(), many.end(), 0.0);
  for (std::size_t i = 0; i < std::min(places.size(), count); ++i) many[places[i]] = few[i];
}
StateNumbers picked(const StateNumbers& many, const std::vector<std::size_t>& places) {
  StateNumbers few(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) few[i] = many[places[i]];
  return few;
}
void pick(TangentMap& map, std::size_t dof, const std::vector<std::size_t>& places) {
  const std::size_t size = places.size();
  std::vector<double> m(size * size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) m[i * size + j] = map.slope(places[i], places[j]);
  map.dof = dof;
  map.from.numbers = picked(map.from.numbers, places);
  map.to.numbers = picked(map.to.numbers, places);
  map.m = std::move(m);
}

}  // namespace

std::vector<std::size_t> places_in(std::size_t n, std::size_t room, bool acting) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < n; ++i) places.push_back(i);
  for (std::size_t i = 0; i < n; ++i) places.push_back(room + i);
  if (acting) places.push_back(2 * room);
  return places;
}

StepTangents keeping(std::shared_ptr<const void> owner, StepTangents tangents) {
  const auto keep = [&owner](auto& call) {
    if (call) call = [owner, call = std::move(call)](auto&&... of) { return call(std::forward<decltype(of)>(of)...); };
  };
  keep(tangents.along);
  keep(tangents.plain);
  keep(tangents.extended);
  return tangents;
}

StepTangents without_room(StepTangents roomy, std::size_t n, std::size_t room, bool acting) {
  const std::vector<std::size_t> places = places_in(n, room, acting);
  const std::size_t size = 2 * room + (acting ? 1 : 0);
  const auto spread_state = [places, size](const RunState& x) {
    RunState many{x.t, StateNumbers(size)};
    spread(x.numbers.data(), places, x.size(), many.numbers);
    return many;
  };
  StepTangents made;
  made.end = roomy.end;
  for (const std::size_t place : places)
    if (place < roomy.level.size()) made.level.push_back(roomy.level[place]);
  if (roomy.along)
    made.along = [places, size, spread_state, along = std::move(roomy.along)](
                     const RunState& x, const ActiveMethod& before, const StateNumbers& u, double dt, double level,
                     ChangeOfStep& to) {
      StateNumbers direction(size);
      spread(u.data(), places, u.size(), direction);
      if (!along(spread_state(x), before, direction, dt, level, to)) return false;
      to.to.numbers = picked(to.to.numbers, places);
      to.change = picked(to.change, places);
      return true;
    };
  if (roomy.plain)
    made.plain = [n, places, spread_state, plain = std::move(roomy.plain)](
                     const RunState& x, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
      if (!plain(spread_state(x), keep_going, map)) return false;
      pick(map, n, places);
      return true;
    };
  if (roomy.extended)
    made.extended = [n, room, spread_state, extended = std::move(roomy.extended)](
                        const RunState& x, const StepTangents::KeepGoing& keep_going, TangentMap& map) {
      if (!extended(spread_state(x), keep_going, map)) return false;
      pick(map, n + 1, extended_places_in(n, room));
      return true;
    };
  return made;
}

}  // namespace least
