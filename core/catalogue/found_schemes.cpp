#include "core/catalogue/found_schemes.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "core/run/columns.hpp"
#include "core/run/request.hpp"
#include "core/run/run.hpp"

namespace least {
namespace {

std::span<const FoundScheme> found_schemes() {
  static const std::array all{kepler_splitting_in_text(), boris_in_text(), adaptive_boris_in_text(),
                              harmonic_splitting_in_text(), lifted_splitting_in_equations()};
  return all;
}

/// By which a scene is described: those that are typed.
std::vector<double> typed_parameters(const ProblemCard& card) {
  std::vector<double> parameters;
  parameters.reserve(card.parameters.size());
  for (const auto& parameter : card.parameters) parameters.push_back(parameter.value);
  return parameters;
}

/// One of them on one scene. The backend with the parameters that were asked for last is kept: a search asks for the
/// same again and again.
class FoundRuns {
 public:
  FoundRuns(const FoundScheme& found, const Mechanics& made)
      : found_(found), position_(*find_scheme(found.id)), text_(*made.text()), card_(made.card()) {}
  std::size_t position() const { return position_; }
  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const {
    const auto backend = backend_with(request.scene->parameters);
    std::call_once(columns_known_, [&] { columns_ = columns_of(backend->table().traits, card_); });
    return least::run(*backend, request, columns_, sink, cancelled);
  }

 private:
  std::shared_ptr<const RunBackend> backend_with(std::span<const double> parameters) const {
    std::vector<double> values(parameters.begin(), parameters.end());
    {
      const std::lock_guard lock(mutex_);
      if (last_.second && last_.first == values) return last_.second;
    }
    auto made = found_.backend(text_, parameters);
    const std::lock_guard lock(mutex_);
    last_ = {std::move(values), made};
    return made;
  }

  FoundScheme found_;
  std::size_t position_;
  const text::TextScene& text_;
  const ProblemCard& card_;
  mutable std::once_flag columns_known_;
  mutable std::vector<Column> columns_;
  mutable std::mutex mutex_;
  mutable std::pair<std::vector<double>, std::shared_ptr<const RunBackend>> last_;
};

class FoundMechanics final : public Mechanics {
 public:
  FoundMechanics(std::shared_ptr<const Mechanics> made, std::span<const FoundScheme> found)
      : made_(std::move(made)), card_(made_->card()) {
    for (const FoundScheme& one : found) {
      runs_.push_back(std::make_unique<const FoundRuns>(one, *made_));
      card_.schemes.push_back(runs_.back()->position());
      if (one.describe) one.describe(*made_->text(), typed_parameters(card_), card_);
    }
    std::ranges::sort(card_.schemes);
  }

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return made_->key(); }
  const text::TextScene* text() const override { return made_->text(); }
  std::span<const SchemeCard> schemes() const override { return made_->schemes(); }
  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    const auto own = std::ranges::find(runs_, request.scheme, [](const auto& one) { return one->position(); });
    return own == runs_.end() ? made_->run(request, sink, cancelled) : (*own)->run(request, sink, cancelled);
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
  std::shared_ptr<const Mechanics> made_;
  ProblemCard card_;
  std::vector<std::unique_ptr<const FoundRuns>> runs_;
};

}  // namespace

std::shared_ptr<const Mechanics> with_found_schemes(std::shared_ptr<const Mechanics> made) {
  const text::TextScene* text = made->text();
  if (!text) return made;
  const std::vector<double> parameters = typed_parameters(made->card());
  std::vector<FoundScheme> fitting;
  for (const FoundScheme& one : found_schemes())
    if (one.concerns(*text->form) && one.objection(*text, parameters).empty()) fitting.push_back(one);
  if (fitting.empty()) return made;
  return std::make_shared<const FoundMechanics>(std::move(made), fitting);
}

std::string objection_to_scheme(const Scene& scene, std::string_view scheme) {
  const text::TextScene* text = scene.mechanics->text();
  if (!text || scene.parameters.size() != scene.card().parameters.size()) return {};
  const auto found = std::ranges::find(found_schemes(), scheme, &FoundScheme::id);
  if (found == found_schemes().end() || !found->concerns(*text->form)) return {};
  return found->objection(*text, scene.parameters);
}

}  // namespace least
