#include "core/catalogue/sized_mechanics.hpp"

#include <mutex>
#include <utility>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/compiled.hpp"
#include "core/catalogue/sized_backend.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/series_truth.hpp"
#include "core/run/run.hpp"
#include "core/run/scales.hpp"
#include "core/schemes/held_program.hpp"

namespace least {
namespace {

class SizedMechanics final : public Mechanics {
 public:
  explicit SizedMechanics(text::TextScene scene) : text_(std::move(scene)), key_(text_.definition.key()) {
    std::vector<double> parameters;
    for (const auto& parameter : text_.definition.parameters) parameters.push_back(parameter.second);
    const auto sized = scene_of(parameters);
    traits_ = traits_of(*sized);
    card_ = complete_card(text_.described(), traits_, schemes_of(*sized));
    card_.offers += ", with more coordinates than schemes that solve equations or transform the time take";
    kinds_ = kinds_of(card_);
    columns_ = columns_of(traits_, card_);
  }

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return key_; }
  const text::TextScene* text() const override { return &text_; }
  std::span<const SchemeCard> schemes() const override { return scheme_cards(); }

  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    return least::run(SizedBackend(scene_of(request.scene->parameters)), request, columns_, sink, cancelled);
  }
  std::optional<RegularStart> regular_start(std::span<const double>, double) const override { return std::nullopt; }
  Scales scales(const Scene& scene) const override {
    const auto sized = scene_of(scene.parameters);
    const auto program = taylor::program_of(sized->equations, sized->rates, sized->rates.size());
    Scales scales = scales_of_motion(program, scene.initial.data(), scene.start, sized->components, traits_.dof);
    if (!std::isfinite(scales.time)) scales.time = 0;
    scales.damped = traits_.linear_contact;
    return scales;
  }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    const SizedBackend backend(scene_of(scene.parameters));
    return truth_by_series(backend, backend.motion().start(scene.initial, scene.start), times, keep_going, kinds_);
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(scene_of(scene.parameters));
    return conditioning_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going, kinds_);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(scene_of(scene.parameters));
    return pace_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time(const Scene&, double, double, const KeepGoing&) const override { return unknown; }

 private:
  /// With these parameters. The last one that was asked for is kept: a search asks for the same again and again.
  std::shared_ptr<const text::SizedScene> scene_of(std::span<const double> parameters) const {
    std::vector<double> values(parameters.begin(), parameters.end());
    {
      const std::lock_guard lock(mutex_);
      if (last_.second && last_.first == values) return last_.second;
    }
    auto made = std::make_shared<const text::SizedScene>(*text_.form, parameters);
    const std::lock_guard lock(mutex_);
    last_ = {std::move(values), made};
    return made;
  }

  text::TextScene text_;
  std::string key_;
  ProblemTraits traits_;
  ProblemCard card_;
  std::vector<std::size_t> kinds_;  ///< of the variables
  std::vector<Column> columns_;
  mutable std::mutex mutex_;
  mutable std::pair<std::vector<double>, std::shared_ptr<const text::SizedScene>> last_;
};

}  // namespace

std::shared_ptr<const Mechanics> sized_mechanics(text::TextScene scene) {
  return std::make_shared<const SizedMechanics>(std::move(scene));
}

}  // namespace least
