#include "core/catalogue/found_schemes.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/run/columns.hpp"
#include "core/run/request.hpp"
#include "core/run/run.hpp"

namespace least {
namespace {

std::span<const FoundScheme> found_schemes() {
  static const std::array all{kepler_splitting_found(), boris_found(), adaptive_boris_found(),
                              harmonic_splitting_found(), lifted_splitting_found()};
  return all;
}

/// described_parameters returns the parameters with which a scene is described: those that were typed, or the defaults
/// of the catalogue.
std::vector<double> described_parameters(const ProblemCard& card) {
  std::vector<double> parameters;
  parameters.reserve(card.parameters.size());
  for (const auto& parameter : card.parameters) parameters.push_back(parameter.value);
  return parameters;
}

/// Readable gives the text of mechanics with certain parameters in which schemes search: its own, or the recorded
/// problem of the catalogue.
class Readable {
 public:
  Readable(const Mechanics& mechanics, std::span<const double> parameters) : typed_(mechanics.text()) {
    if (!typed_) {
      recorded_ = recorded_text(mechanics.card(), parameters, false);
    } else if (typed_->form->tape.has_terms()) {
      written_out_ = *typed_;
      written_out_->form = text::with_sums_written_out(typed_->form);
    }
  }
  bool is_known_to(const FoundScheme& scheme) const { return text() && scheme.concerns(*text()->form, !typed_); }
  /// Null for a scene whose sums are too long to be written out.
  const text::TextScene* text() const {
    if (written_out_) return written_out_->form ? &*written_out_ : nullptr;
    return typed_ ? typed_ : recorded_ ? &*recorded_ : nullptr;
  }

 private:
  const text::TextScene* typed_;
  std::optional<text::TextScene> recorded_, written_out_;
};

/// FoundRuns runs one such scheme on one scene. It keeps what was found for the last parameters, since a search asks
/// for the same again and again.
class FoundRuns {
 public:
  FoundRuns(const FoundScheme& scheme, const Mechanics& made, std::vector<double> parameters,
            std::shared_ptr<const Found> found)
      : scheme_(scheme),
        position_(*find_scheme(scheme.id)),
        made_(made),
        last_(std::move(parameters), std::move(found)) {}
  std::size_t position() const { return position_; }
  std::unique_ptr<const RunBackend> backend(const Request& request) const {
    return std::make_unique<const FoundBackend>(made_.backend(request), found_with(request.scene->parameters));
  }
  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const {
    const auto problem = backend(request);
    std::call_once(columns_known_, [&] { columns_ = columns_of(problem->table().traits, made_.card()); });
    return least::run(*problem, request, columns_, sink, cancelled);
  }

 private:
  std::shared_ptr<const Found> found_with(const std::vector<double>& parameters) const {
    {
      const std::lock_guard lock(mutex_);
      if (last_.first == parameters) return last_.second;
    }
    auto found = scheme_.look(*Readable(made_, parameters).text(), parameters);
    const std::lock_guard lock(mutex_);
    last_ = {parameters, found};
    return found;
  }

  FoundScheme scheme_;
  std::size_t position_;
  const Mechanics& made_;
  mutable std::once_flag columns_known_;
  mutable std::vector<Column> columns_;
  mutable std::mutex mutex_;
  mutable std::pair<std::vector<double>, std::shared_ptr<const Found>> last_;
};

class FoundMechanics final : public Mechanics {
 public:
  FoundMechanics(std::shared_ptr<const Mechanics> made, const std::vector<double>& parameters,
                 const std::vector<std::pair<FoundScheme, std::shared_ptr<const Found>>>& all)
      : made_(std::move(made)), card_(made_->card()) {
    for (const auto& [scheme, found] : all) {
      runs_.push_back(std::make_unique<const FoundRuns>(scheme, *made_, parameters, found));
      card_.schemes.push_back(runs_.back()->position());
      found->describe(card_);
    }
    std::ranges::sort(card_.schemes);
  }

  const ProblemCard& card() const override { return card_; }
  std::string_view key() const override { return made_->key(); }
  const text::TextScene* text() const override { return made_->text(); }
  std::span<const SchemeCard> schemes() const override { return made_->schemes(); }
  std::unique_ptr<const RunBackend> backend(const Request& request) const override {
    const FoundRuns* own = runs_by(request.scheme);
    return own ? own->backend(request) : made_->backend(request);
  }
  Solution run(const Request& request, RowSink& sink, const std::atomic<bool>& cancelled) const override {
    const FoundRuns* own = runs_by(request.scheme);
    return own ? own->run(request, sink, cancelled) : made_->run(request, sink, cancelled);
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
  /// Null if the scheme is not one of those that were found.
  const FoundRuns* runs_by(std::size_t scheme) const {
    const auto own = std::ranges::find(runs_, scheme, [](const auto& one) { return one->position(); });
    return own == runs_.end() ? nullptr : own->get();
  }

  std::shared_ptr<const Mechanics> made_;
  ProblemCard card_;
  std::vector<std::unique_ptr<const FoundRuns>> runs_;
};

/// Null if it is not such a scheme, or does not concern this scene.
std::shared_ptr<const Found> looked_for(const Scene& scene, std::string_view scheme) {
  const auto known = std::ranges::find(found_schemes(), scheme, &FoundScheme::id);
  if (known == found_schemes().end() || scene.parameters.size() != scene.card().parameters.size()) return nullptr;
  const Readable readable(*scene.mechanics, scene.parameters);
  return readable.is_known_to(*known) ? known->look(*readable.text(), scene.parameters) : nullptr;
}

}  // namespace

std::shared_ptr<const Mechanics> with_found_schemes(std::shared_ptr<const Mechanics> made) {
  const std::vector<double> parameters = described_parameters(made->card());
  const Readable readable(*made, parameters);
  std::vector<std::pair<FoundScheme, std::shared_ptr<const Found>>> fitting;
  for (const FoundScheme& scheme : found_schemes()) {
    if (!readable.is_known_to(scheme)) continue;
    if (auto found = scheme.look(*readable.text(), parameters); found->objection().empty())
      fitting.emplace_back(scheme, std::move(found));
  }
  if (fitting.empty()) return made;
  return std::make_shared<const FoundMechanics>(std::move(made), parameters, fitting);
}

std::shared_ptr<const Found> found_in(const Scene& scene, std::string_view scheme) {
  const auto found = looked_for(scene, scheme);
  return found && found->objection().empty() ? found : nullptr;
}

std::string objection_to_scheme(const Scene& scene, std::string_view scheme) {
  const auto found = looked_for(scene, scheme);
  return found ? found->objection() : std::string();
}

}  // namespace least
