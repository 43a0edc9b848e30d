#include "core/catalogue/sized_mechanics.hpp"

#include <mutex>
#include <utility>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/compiled.hpp"
#include "core/catalogue/sized_backend.hpp"
#include "core/catalogue/sized_fits.hpp"
#include "core/catalogue/turned_momenta.hpp"
#include "core/memory_budget.hpp"
#include "core/reference/blow_up.hpp"
#include "core/reference/growth.hpp"
#include "core/reference/series_truth.hpp"
#include "core/run/run.hpp"
#include "core/run/scales.hpp"
#include "core/schemes/held_program.hpp"
#include "core/text/scenes.hpp"

namespace least {
namespace {

/// digits_of returns the variables of the equations of motion at a state.
std::vector<DoubleDouble> digits_of(const text::SizedScene& scene, const RunState& x) {
  std::vector<Quad> all(x.numbers.begin(), x.numbers.end());
  all.resize(x.size() + scene.found());
  scene.find_velocities(all.data(), x.t);
  return least::digits_of(all);
}

/// truth_of_few returns the truth of a scene of few components whose motion has no series, as with a force that
/// contains |v|, from the variables of its equations. Empty if there are too many.
Truth truth_of_few(const text::SizedScene& scene, const std::vector<double>& initial, double start,
                   const std::vector<double>& times, const KeepGoing& keep_going, std::vector<std::size_t> kinds) {
  constexpr std::size_t room = text::compiled_variables;
  const std::size_t count = scene.moving + scene.found();
  if (count > room) return {};
  text::Form form;
  form.kind = text::FormKind::flow;
  form.autonomous = scene.autonomous;
  form.coordinates = count;
  form.numbers = text::Numbering::of_flow(count);
  form.tape = scene.equations;
  for (std::size_t i = 0; i < count; ++i) form.rates.push_back(Symbol::at(form.tape, scene.rates[i]));
  text::FlowScene flow;
  flow.formulas = std::make_shared<const text::Formulas>(form, std::span<const double>());
  StateOf<text::FlowScene> x{};
  x.t = start;
  std::vector<double> all(initial.begin(), initial.begin() + static_cast<std::ptrdiff_t>(scene.moving));
  all.resize(count);
  scene.find_velocities(all.data(), start);
  for (std::size_t i = 0; i < count; ++i) x[i] = all[i];
  kinds.resize(room);
  Truth truth = true_states(flow, x, times, keep_going, kinds);
  for (auto& state : truth.states) state.resize(scene.moving);
  truth.sizes.resize(scene.moving);
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
  explicit SizedMechanics(text::TextScene scene)
      : text_(std::move(scene)), key_(text_.definition.key()), forward_(ForwardTable::of(text_)) {
    std::vector<double> parameters;
    for (const auto& parameter : text_.definition.parameters) parameters.push_back(parameter.second);
    const auto sized = text_.sized(parameters);
    traits_ = traits_of(*sized);
    if (forward_) forward_->add_to(traits_);
    card_ = complete_card(text_.described(), traits_, schemes_of(*sized));
    const bool full = sized->forced || traits_.general || traits_.configuration_metric || traits_.quadratic_contact;
    if (full && sized->coordinates > text::SizedScene::most_full)
      card_.offers += ", with more coordinates than the " + std::to_string(text::SizedScene::most_full) +
                      " for which schemes solve equations whose matrix is full";
    if (!sized->solves_for_places())
      card_.offers += ", with masses that couple more coordinates than the " +
                      std::to_string(text::SizedScene::most_with_full_mass) +
                      " for which schemes solve for the next place";
    if (!sized->plain()) card_.offers += ", with sums of more terms than series are made of";
    if (sized->forced && sized->has_constant_metric() && !sized->forces.linear)
      card_.offers += ", and the forces not linear in the momenta";
    if (sized->forced && sized->has_constant_metric() && !sized->forces.solvable())
      card_.offers += ", and the forces coupling more than " + std::to_string(text::SizedScene::most_coupled) +
                      " momenta, too many to solve for in a kick";
    if (sized->forces.jumps)
      card_.summary +=
          knows_rest(*sized)
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
    // Memory of states during the run: those of the steppers, and half a mebibyte of states that diagnostics see
    // together. Diagnostics that follow other motions beside the run hold about half a thousand states.
    const bool follows =
        std::ranges::any_of(request.diagnostics, [&](std::size_t i) { return !card_.diagnostics[i].by_default; });
    const std::size_t states = follows ? 512 : 32, rows = std::size_t(1) << 19;
    const auto sized = text_.sized(request.scene->parameters);
    const Held held = HeldByThread::take_soon(states * card_.variables.size() * sizeof(double) + rows);
    Solution solution = least::run(*backend(request), request, columns_, sink, cancelled);
    if (sized->forces.jumps && solution.stop.reason != ReturnCode::completed)
      solution.warnings.push_back({"force_jumps", force_jumps(knows_rest(*sized))});
    return solution;
  }
  std::unique_ptr<const RunBackend> backend(const Request& request) const override {
    auto sized = text_.sized(request.scene->parameters);
    // Steps by Herglotz' equations, and those of a general H, need the full state.
    const bool all = sized->forced || on_damped_metric(*sized) || asks_for_full_state(card_, request);
    return std::make_unique<const SizedBackend>(std::move(sized), all, forward_);
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
    if (sized->plain()) {
      std::vector<double> all = scene.initial;
      all.resize(std::max(all.size(), sized->moving + sized->found()));
      sized->find_velocities(all.data(), scene.start);
      scales = scales_of_motion(sized->series(false), all.data(), scene.start, sized->moving, traits_.dof);
    }
    if (!std::isfinite(scales.time)) scales.time = 0;
    scales.damped = traits_.linear_contact;
    const std::lock_guard lock(mutex_);
    last_scales_ = {std::move(key), scales};
    return scales;
  }
  Truth truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) const override {
    const auto sized = text_.sized(scene.parameters);
    const SizedBackend backend(sized, true, forward_);
    const RunState start = backend.motion().start(scene.initial, scene.start);
    Truth truth = truth_by_series(backend, start, digits_of(*sized, start), times, keep_going, kinds_);
    if (truth.complete || !truth.states.empty()) return truth;
    const Truth other = truth_of_few(*sized, scene.initial, scene.start, times, keep_going, kinds_);
    return other.states.empty() ? truth : other;
  }
  Conditioning conditioning(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(text_.sized(scene.parameters), true, forward_);
    return conditioning_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going, kinds_);
  }
  std::vector<PaceMark> pace(const Scene& scene, double end, const KeepGoing& keep_going) const override {
    const SizedBackend backend(text_.sized(scene.parameters), true, forward_);
    return pace_of(backend, backend.motion().start(scene.initial, scene.start), end, keep_going);
  }
  double blow_up_time(const Scene& scene, double latest, double step, const KeepGoing& keep_going) const override {
    if (!traits_.quadratic_contact) return unknown;
    const SizedBackend backend(text_.sized(scene.parameters), true, forward_);
    return true_blow_up_time(backend, backend.motion().start(scene.initial, scene.start), latest, step, keep_going);
  }

 private:
  text::TextScene text_;
  std::string key_;
  std::shared_ptr<const ForwardTable> forward_;
  ProblemTraits traits_;
  ProblemCard card_;
  std::vector<std::size_t> kinds_;  ///< kinds of the variables (kinds_of)
  std::vector<Column> columns_;
  mutable std::mutex mutex_;
  mutable std::pair<std::string, Scales> last_scales_;  ///< by the key of the scene; a search needs them repeatedly
};

}  // namespace

std::shared_ptr<const Mechanics> sized_mechanics(text::TextScene scene) {
  return std::make_shared<const SizedMechanics>(std::move(scene));
}

}  // namespace least
