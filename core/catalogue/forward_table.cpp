#include "core/catalogue/forward_table.hpp"

#include "core/run/request.hpp"

namespace least {

std::shared_ptr<const ForwardTable> ForwardTable::of(const text::TextScene& scene) {
  if (!scene.forward || scene.forward->mechanics->text()) return nullptr;
  return std::shared_ptr<const ForwardTable>(new ForwardTable(scene));
}

ForwardTable::ForwardTable(const text::TextScene& scene) {
  Request request;
  request.scene = scene.forward;
  backend_ = scene.forward->mechanics->backend(request);
  while (turning_ < table().traits.components && !scene.turns(turning_)) ++turning_;
}

void ForwardTable::add_to(ProblemTraits& traits) const {
  const ProblemTraits& known = table().traits;
  traits.quantities = known.quantities;
  traits.elements = known.elements;
  traits.has_energy = traits.has_energy || known.has_energy;
}

RunState ForwardTable::turned(StateView x) const {
  RunState state{0 - x.t, StateNumbers(x.numbers, x.numbers + table().traits.components)};
  for (std::size_t i = turning_; i < state.numbers.size(); ++i) state.numbers[i] = 0 - state.numbers[i];
  return state;
}

}  // namespace least
