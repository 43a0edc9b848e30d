#include "core/catalogue/sized_mechanics.hpp"

#include <mutex>
#include <utility>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/compiled.hpp"
#include "core/catalogue/sized_backend.hpp"
#include "core/memory_budget.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/series_truth.hpp"
#include "core/run/run.hpp"
#include "core/run/scales.hpp"
#include "core/schemes/held_program.hpp"
#include "core/text/scenes.hpp"

namespace least {
namespace {

/// Of a scene of few components whose motion has no series, as where a force has |v|: of the variables that it has.
/// Empty where there are too many.
Truth truth_of_few(const text::SizedScene& scene, const std::vector<double>& initial, double start,
                   const std::vector<double>& times, const KeepGoing& keep_going, std::vector<std::size_t> kinds) {
  constexpr std::size_t room = text::compiled_variables;
  if (scene.moving > room) return {};
  text::Form form;
  form.kind = text::FormKind::flow;
  form.autonomous = scene.autonomous;
  form.coordinates = scene.moving;
  form.numbers = text::Numbering::of_flow(scene.moving);
  form.tape = scene.equations;
  for (std::size_t i = 0; i < scene.moving; ++i) form.rates.push_back(Symbol::at(form.tape, scene.rates[i]));
  text::FlowScene flow;
  flow.formulas = std::make_shared<const text::Formulas>(form, std::span<const double>());
  StateOf<text::FlowScene> x{};
  x.t = start;
  for (std::size_t i = 0; i < scene.moving; ++i) x[i] = initial[i];
  kinds.resize(room);
  Truth truth = true_states(flow, x, times, keep_going, kinds);
  for (auto& state : truth.states) state.resize(initial.size());
  truth.sizes.resize(initial.size());
  return truth;
}

std::string force_jumps(bool can_rest) {
  return std::string(
             "a force jumps with the velocity, as dry friction does; where something comes to rest under it, ") +
         (can_rest ? "leapfrog, symplectic_euler and compositions of them go on, other schemes do not"
                   : "no scheme goes on, as it jumps with the velocities of others");
}

class SizedMechanics final : public Mechanics {
 public:
  explicit SizedMechanics(text::TextScene scene) : text_(std::move(scene)), key_(text_.definition.key()) {
    std::vector<double> parameters;
    for (const auto& parameter : text_.definition.parameters) parameters.push_back(parameter.second);
    const auto sized = text_.sized(parameters);
    traits_ = traits_of(*sized);
    card_ = complete_card(text_.described(), traits_, schemes_of(*sized));
    if (!sized->forced && sized->kind == text::FormKind::metric)
      card_.offers += ", with more coordinates than the " + std::to_string(text::compiled_coordinates) +
                      " for which schemes follow a level of the energy there";
    if (!sized->forced && !traits_.potential && sized->coordinates > text::SizedScene::most_full)
      card_.offers += ", with more coordinates than the " + std::to_string(text::SizedScene::most_full) +
                      " for which schemes solve equations whose matrix is full";
    if (!sized->solves_for_places())
      card_.offers += ", with masses that couple more coordinates than the " +
                      std::to_string(text::SizedScene::most_with_full_mass) +
                      " for which schemes solve for the next place";
    if (!sized->plain()) card_.offers += ", with sums of more terms than series are made of";
    if (sized->forced && traits_.potential && !sized->forces.linear)
      card_.offers += ", and the forces not linear in the momenta";
    if (sized->forced && traits_.potential && !sized->forces.solvable())
      card_.offers += ", and the forces coupling more than " + std::to_string(text::SizedScene::most_coupled) +
                      " momenta, too many to solve for in a kick";
    if (sized->forces.jumps)
      card_.summary +=
          sized->forces.can_rest()
              ? " A force jumps with the velocity: leapfrog, symplectic_euler and compositions of them know "
                "what it holds at rest, no other scheme does."
              : " A force jumps with velocities of others: no scheme knows what it holds at rest.";
    if (sized->forces.friction > 0)
      card_.summary +=
          " Its force is friction −c p: as damping it keeps the contact form, and schemes for that do better.";
    kinds_ = kinds_of(card_);
    columns_ = columns_of(traits_, card_);
  }

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return key_; }
  const text::TextScene* text() const override { return &text_; }
  std::span<const SchemeCard> schemes() const override { return scheme_cards(); }

  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    // States on their way: those between which steps lead, and of those that diagnostics see together half a mebibyte.
    // What diagnostics follow beside the run takes as much as half a thousand.
    const bool follows =
        std::ranges::any_of(request.diagnostics, [&](std::size_t i) { return !card_.diagnostics[i].by_default; });
    const std::size_t states = follows ? 512 : 32, rows = std::size_t(1) << 19;
    const auto sized = text_.sized(request.scene->parameters);
    const Held held = HeldByThread::take_soon(states * card_.variables.size() * sizeof(double) + rows);
    Solution solution = least::run(*backend(request), request, columns_, sink, cancelled);
    if (sized->forces.jumps && solution.stop.reason != ReturnCode::completed)
      solution.warnings.push_back({"force_jumps", force_jumps(sized->forces.can_rest())});
    return solution;
  }
  std::unique_ptr<const RunBackend> backend(const Request& request) const override {
    auto sized = text_.sized(request.scene->parameters);
    const bool all = sized->forced || asks_for_full_state(card_, request);
    return std::make_unique<const SizedBackend>(std::move(sized), all);
  }
  std::optional<RegularStart> regular_start(std::span<const double>, double) const override { return std::nullopt; }
  Scales scales(const Scene& scene) const override {
    std::string key = scene.key();
    {
      const std::lock_guard lock(mutex_);
      if (last_scales_.first == key) return last_scales_.second;
    }
    const auto sized = text_.sized(scene.parameters);
    Scales scales;
    if (sized->plain())
      scales = scales_of_motion(sized->series(false), scene.initial.data(), scene.start, sized->moving, traits_.dof);
    if (!std::isfinite(scales.time)) scales.time = 0;
    scales.damped = traits_.linear_contact;
    const std::lock_guard lock(mutex_);
    last_scales_ = {std::move(key), scales};
    return scales;
  }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    const auto sized = text_.sized(scene.parameters);
    const SizedBackend backend(sized);
    Truth truth =
        truth_by_series(backend, backend.motion().start(scene.initial, scene.start), times, keep_going, kinds_);
    if (truth.complete || !truth.states.empty()) return truth;
    const Truth other = truth_of_few(*sized, scene.initial, scene.start, times, keep_going, kinds_);
    return other.states.empty() ? truth : other;
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(text_.sized(scene.parameters));
    return conditioning_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going, kinds_);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(text_.sized(scene.parameters));
    return pace_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time(const Scene&, double, double, const KeepGoing&) const override { return unknown; }

 private:
  text::TextScene text_;
  std::string key_;
  ProblemTraits traits_;
  ProblemCard card_;
  std::vector<std::size_t> kinds_;  ///< of the variables
  std::vector<Column> columns_;
  mutable std::mutex mutex_;
  mutable std::pair<std::string, Scales> last_scales_;  ///< by the key of the scene; a search asks again and again
};

}  // namespace

std::shared_ptr<const Mechanics> sized_mechanics(text::TextScene scene) {
  return std::make_shared<const SizedMechanics>(std::move(scene));
}

}  // namespace least
