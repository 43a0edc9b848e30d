#include "core/catalogue/recorded_tangents.hpp"

#include "core/catalogue/custom.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/catalogue/roomy_tangents.hpp"
#include "core/run/backend.hpp"

namespace least {

StepTangents recorded_tangents(const Request& request) {
  const Scene& scene = *request.scene;
  auto text = recorded_text(scene.card(), scene.parameters, false);
  auto made = mechanics_of(std::move(*text));
  const auto mechanics = std::get<std::shared_ptr<const Mechanics>>(std::move(made));
  const text::TextScene& known = *mechanics->text();
  const std::size_t n = known.form->coordinates, room = static_cast<std::size_t>(known.capacity);

  Scene recorded{mechanics, {}, std::vector<double>(mechanics->card().variables.size()), scene.start};
  const auto places = places_in(n, room, recorded.initial.size() > 2 * room);
  for (std::size_t i = 0; i < std::min(places.size(), scene.initial.size()); ++i)
    recorded.initial[places[i]] = scene.initial[i];
  Request asked;
  asked.scene = std::make_shared<const Scene>(std::move(recorded));
  asked.scheme = request.scheme;
  asked.settings = request.settings;
  asked.until_steps = request.until_steps;
  asked.end = request.end;
  const std::shared_ptr<const RunBackend> backend = mechanics->backend(asked);
  StepTangents tangents = keeping(backend, backend->tangents(asked));
  if (n == room) return tangents;
  return without_room(std::move(tangents), n, room, backend->table().traits.acting);
}

}  // namespace least
