#include "core/catalogue/recorded_tangents.hpp"

#include "core/catalogue/custom.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/run/backend.hpp"

namespace least {
namespace {

/// keeping returns the same tangents, which keep `owner` alive as long as they exist.
StepTangents keeping(std::shared_ptr<const void> owner, StepTangents tangents) {
  const auto keep = [&owner](auto& call) {
    if (call) call = [owner, call = std::move(call)](auto&&... of) { return call(std::forward<decltype(of)>(of)...); };
  };
  keep(tangents.along);
  keep(tangents.plain);
  keep(tangents.extended);
  return tangents;
}

}  // namespace

StepTangents recorded_tangents(const Request& request) {
  const Scene& scene = *request.scene;
  auto text = recorded_text(scene.card(), scene.parameters, false);
  auto made = mechanics_of(std::move(*text));
  const auto mechanics = std::get<std::shared_ptr<const Mechanics>>(std::move(made));

  Scene recorded{mechanics, {}, scene.initial, scene.start};
  recorded.initial.resize(mechanics->card().variables.size());
  Request asked;
  asked.scene = std::make_shared<const Scene>(std::move(recorded));
  asked.scheme = request.scheme;
  asked.settings = request.settings;
  asked.until_steps = request.until_steps;
  asked.end = request.end;
  const std::shared_ptr<const RunBackend> backend = mechanics->backend(asked);
  return keeping(backend, backend->tangents(asked));
}

}  // namespace least
