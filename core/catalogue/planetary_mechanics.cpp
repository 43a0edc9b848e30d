#include "core/catalogue/planetary_mechanics.hpp"

#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/planetary_stepper.hpp"
#include "core/catalogue/sized_backend.hpp"
#include "core/catalogue/sized_steps.hpp"
#include "core/from_values.hpp"
#include "core/run/request.hpp"
#include "core/run/run.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

using Found = std::variant<text::Planetary, text::NotPlanetary>;

Found found_in(const text::TextScene& scene, std::span<const double> parameters) {
  return text::planetary(*scene.form, parameters, scene.definition.variables);
}

/// What is known of a scene with these parameters.
struct PlanetaryScene {
  std::shared_ptr<const text::SizedScene> sized;  ///< with the places that its class has room for
  std::shared_ptr<const text::Planetary> bodies;  ///< null: it has none
  std::string why;                                ///< of that
  std::size_t known, room;                        ///< coordinates, and those that there is room for

  PlanetaryScene(const text::TextScene& scene, std::span<const double> parameters)
      : known(scene.form->coordinates), room(static_cast<std::size_t>(scene.capacity)) {
    text::Form with_room = *scene.form;
    with_room.coordinates = room;
    sized = std::make_shared<const text::SizedScene>(with_room, parameters);
    auto found = found_in(scene, parameters);
    if (auto* none = std::get_if<text::NotPlanetary>(&found)) {
      why = std::move(none->why);
    } else {
      bodies = std::make_shared<const text::Planetary>(std::get<text::Planetary>(std::move(found)));
    }
  }
};

/// The stepper as steps of equal length want it. Without bodies it takes no step.
class KeplerSteps {
 public:
  KeplerSteps(const PlanetaryScene& scene, const KeplerSplitting& scheme) : why_(scene.why) {
    if (!scene.bodies) return;
    // Jump and kick make one part of weak forces only where they commute: a force on all light bodies alike is none.
    const bool heliocentric = scheme.coordinates == KeplerCoordinates::heliocentric && scene.bodies->about_body;
    if (scheme.turns() && heliocentric && scene.bodies->rest.outputs() > 0)
      why_ =
          "saba and aba lose their order in heliocentric coordinates where V has more than attractions; jacobi keeps "
          "it";
    else
      stepper_.emplace(scene.bodies, scheme, scene.room);
  }
  void begin(StateView x) {
    if (stepper_) stepper_->begin(x.numbers, x.t);
  }
  StepStatus step(double* x, double t, double h) noexcept {
    return stepper_ ? stepper_->step(x, t, h) : StepStatus::singular;
  }
  Work work() const { return stepper_ ? stepper_->work() : Work(); }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }
  std::string unsupported_reason() const {
    return why_.empty() ? why_ : "kepler_splitting does not run this scene with these parameters: " + why_;
  }

 private:
  std::optional<PlanetaryStepper<double>> stepper_;
  std::string why_;
};

KeplerSplitting scheme_of(const Request& request) {
  return from_values<KeplerSplitting>(KeplerSplitting::fields, request.settings);
}

class PlanetaryBackend final : public SizedBackend {
 public:
  explicit PlanetaryBackend(std::shared_ptr<const PlanetaryScene> scene)
      : SizedBackend(scene->sized), scene_(std::move(scene)) {}

  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid& grid, double) const override {
    return std::make_unique<SizedSteps<KeplerSteps>>(table(), KeplerSteps(*scene_, scheme_of(request)), x, grid);
  }
  bool has_component(std::size_t i) const override { return i % scene_->room < scene_->known; }

  StepTangents tangents(const Request& request) const override {
    StepTangents tangents;
    if (!scene_->bodies) return tangents;
    if (!request.until_steps) tangents.end = request.end;
    const std::vector<Slope> began(request.scene->initial.begin(), request.scene->initial.end());
    const auto along = [scene = scene_, scheme = scheme_of(request), began](const RunState& x, const StateNumbers& u,
                                                                            std::vector<Slope>& y) {
      y.resize(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) y[i] = Slope(x[i], {u[i]});
      PlanetaryStepper<Slope> stepper(scene->bodies, scheme, scene->room);
      stepper.begin(y.data(), x.t, began.data());
      return stepper.step(y.data(), x.t, scheme.step) == StepStatus::ok;
    };
    const double step = scheme_of(request).step;
    tangents.along = [along, step](const RunState& x, const ActiveMethod&, const StateNumbers& u, double, double,
                                   ChangeOfStep& to) {
      std::vector<Slope> y;
      if (!along(x, u, y)) return false;
      to = {{x.t + step, StateNumbers(x.size())}, StateNumbers(x.size())};
      for (std::size_t i = 0; i < y.size(); ++i) {
        to.to[i] = y[i].value;
        to.change[i] = y[i].slope[0];
      }
      return true;
    };
    tangents.plain = [along, step, scene = scene_, this](const RunState& x, TangentMap& map) {
      const std::size_t size = x.size();
      map = {scene->room, x, x, std::vector<double>(size * size)};
      map.to.t = x.t + step;
      std::vector<Slope> y;
      for (std::size_t j = 0; j < size; ++j) {
        StateNumbers u(size);
        u[j] = map.m[j * size + j] = 1;
        if (!has_component(j)) continue;
        if (!along(x, u, y)) return false;
        for (std::size_t i = 0; i < size; ++i) {
          map.to[i] = y[i].value;
          map.m[i * size + j] = y[i].slope[0];
        }
      }
      return true;
    };
    tangents.level.assign(2 * scene_->room, 0);
    return tangents;
  }

 private:
  std::shared_ptr<const PlanetaryScene> scene_;
};

class PlanetaryMechanics final : public Mechanics {
 public:
  PlanetaryMechanics(std::shared_ptr<const Mechanics> made, std::size_t scheme)
      : made_(std::move(made)), card_(made_->card()), scheme_(scheme), columns_([&] {
          std::vector<double> parameters;
          for (const auto& parameter : card_.parameters) parameters.push_back(parameter.value);
          return columns_of(traits_of(*scene_of(parameters)->sized), card_);
        }()) {
    card_.schemes.push_back(scheme);
    std::ranges::sort(card_.schemes);
  }

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return made_->key(); }
  const text::TextScene* text() const override { return made_->text(); }
  std::span<const SchemeCard> schemes() const override { return made_->schemes(); }
  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    if (request.scheme != scheme_) return made_->run(request, sink, cancelled);
    return least::run(PlanetaryBackend(scene_of(request.scene->parameters)), request, columns_, sink, cancelled);
  }
  std::optional<RegularStart> regular_start(std::span<const double> parameters, double t) const override {
    return made_->regular_start(parameters, t);
  }
  Scales scales(const Scene& scene) const override { return made_->scales(scene); }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    return made_->truth(scene, times, keep_going);
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    return made_->conditioning(scene, end, keep_going);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    return made_->pace(scene, end, keep_going);
  }
  double blow_up_time(const Scene& scene, double latest, double step, const KeepGoing& keep_going) const override {
    return made_->blow_up_time(scene, latest, step, keep_going);
  }

 private:
  /// The last one that was asked for is kept: a search asks for the same again and again.
  std::shared_ptr<const PlanetaryScene> scene_of(std::span<const double> parameters) const {
    std::vector<double> values(parameters.begin(), parameters.end());
    {
      const std::lock_guard lock(mutex_);
      if (last_.second && last_.first == values) return last_.second;
    }
    auto made = std::make_shared<const PlanetaryScene>(*text(), parameters);
    const std::lock_guard lock(mutex_);
    last_ = {std::move(values), made};
    return made;
  }

  std::shared_ptr<const Mechanics> made_;
  ProblemCard card_;
  std::size_t scheme_;  ///< its position
  mutable std::mutex mutex_;
  mutable std::pair<std::vector<double>, std::shared_ptr<const PlanetaryScene>> last_;
  std::vector<Column> columns_;
};

constexpr std::string_view kepler_id = "kepler_splitting";

}  // namespace

std::shared_ptr<const Mechanics> with_kepler_splitting(std::shared_ptr<const Mechanics> made) {
  const text::TextScene* text = made->text();
  if (!text || text->form->kind != text::FormKind::separable || text->form->forced) return made;
  std::vector<double> parameters;
  parameters.reserve(made->card().parameters.size());
  for (const auto& parameter : made->card().parameters) parameters.push_back(parameter.value);
  if (std::holds_alternative<text::NotPlanetary>(found_in(*text, parameters))) return made;
  return std::make_shared<const PlanetaryMechanics>(std::move(made), *find_scheme(kepler_id));
}

std::string objection_to_scheme(const Scene& scene, std::string_view scheme) {
  const text::TextScene* text = scene.mechanics->text();
  if (!text || scheme != kepler_id || scene.parameters.size() != scene.card().parameters.size()) return {};
  const auto found = found_in(*text, scene.parameters);
  const auto* none = std::get_if<text::NotPlanetary>(&found);
  return none ? none->why : std::string();
}

}  // namespace least
