#include "core/study/error_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/composition.hpp"
#include "core/problem_traits.hpp"
#include "core/run/suggestions.hpp"
#include "core/state_error.hpp"

namespace least {
namespace {

/// said returns a setting as a request would give it.
std::string said(const ParameterCard& parameter, double value) {
  if (has_weights(parameter, value)) return "weights";
  if (parameter.kind == Kind::choice) return std::string(parameter.choices[static_cast<std::size_t>(value)]);
  if (std::isnan(value)) return std::string(parameter.word.empty() ? "null" : parameter.word);
  return fmt::format("{}", value);
}

/// with_each combines every choice with every value; combinations that the card rules out are removed by the caller.
std::vector<SchemeConfig> with_each(const std::vector<SchemeConfig>& choices, std::size_t index,
                                    const std::vector<double>& values) {
  std::vector<SchemeConfig> all;
  for (const SchemeConfig& choice : choices)
    for (const double value : values) {
      all.push_back(choice);
      all.back().settings[index] = value;
    }
  return all;
}

bool keeps(const SchemeCard& scheme, const ProblemCard& problem, const Keep& keep) {
  const bool form = (scheme.structure == "symplectic" || scheme.structure == "contact") && problem.keeps_form;
  if (keep.structure && !form) return false;
  if (keep.energy && !form && !(scheme.symmetric && problem.keeps_energy)) return false;
  return !keep.momenta || form || (scheme.keeps_momenta && problem.keeps_form);
}

}  // namespace

std::string name(const SchemeCard& card, const SchemeConfig& choice) {
  std::string words(card.id);
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    const ParameterCard& parameter = card.parameters[i];
    const double value = choice.settings[i];
    if (value == parameter.value || (parameter.kind == Kind::number && !std::isnan(value))) continue;
    const bool plain = parameter.name == "composition" || parameter.kind != Kind::choice;
    words += parameter.name == "composition" ? ", " : fmt::format(", {} ", parameter.name);
    words += plain || !parameter.choices.empty() ? said(parameter, value) : "";
  }
  return words;
}

ResolutionParameter::ResolutionParameter(const SchemeCard& card) {
  for (const std::string_view candidate : {"tolerance", "theta", "sigma", "step"})
    if (const auto found = card.find(candidate)) {
      name = candidate;
      index = *found;
      break;
    }
  range = card.parameters[index].range;
  if (name == "theta") companion = card.find("step");
}

SchemeConfig ResolutionParameter::at(const SchemeConfig& choice, double value) const {
  SchemeConfig turned = choice;
  value = std::clamp(value, range.low, range.high);
  if (companion) turned.settings[*companion] *= value / choice.settings[index];
  turned.settings[index] = value;
  return turned;
}

int declared_order(const SchemeCard& card, const SchemeConfig& choice) {
  return ResolutionParameter(card).adaptive() ? 0 : card.order(choice.settings);
}

namespace {

template <class SettingsOf>
std::vector<SchemeConfig> candidates_by(SettingsOf&& settings_of, const Mechanics& mechanics, const Keep& keep) {
  const ProblemCard& problem_card = mechanics.card();
  std::vector<SchemeConfig> all;
  for (const std::size_t scheme : problem_card.schemes) {
    const SchemeCard& card = mechanics.schemes()[scheme];
    if (!keeps(card, problem_card, keep)) continue;
    const SchemeConfig plain{scheme, settings_of(card)};
    std::vector<SchemeConfig> variants{plain};
    if (const auto kappa = card.find("kappa"))
      variants = with_each(variants, *kappa, {plain.settings[*kappa], unknown});
    if (const auto stages = card.find("stages")) {
      const Range& range = card.parameters[*stages].range;
      std::vector<double> counts(static_cast<std::size_t>(range.high - range.low) + 1);
      std::iota(counts.begin(), counts.end(), range.low);
      variants = with_each(variants, *stages, counts);
    }
    if (const auto composition = card.find("composition")) {
      const auto index = [](const Composition& c) { return static_cast<double>(c); };
      std::vector<double> useful{index(Composition::none)};
      for (const Composition c : {Composition::suzuki_4, Composition::kahan_li_6, Composition::kahan_li_8,
                                  Composition::sofroniou_spaletta_10})
        if (card.orders[static_cast<std::size_t>(c)].second > card.orders.front().second) useful.push_back(index(c));
      variants = with_each(variants, *composition, useful);
    }
    // A tolerance chooses the order that suits a typical motion: another order may be cheaper by a tenth.
    if (const auto order = card.find("order"); order && card.find("tolerance"))
      variants = with_each(variants, *order, {0, 12, 16, 20});
    if (const auto splitting = card.find("splitting")) {
      const auto& choices = card.parameters[*splitting].choices;
      for (std::size_t i = 0; i < choices.size(); ++i)  // splittings with an order of their own
        if (std::ranges::count(card.orders, choices[i], [](const auto& entry) { return entry.first; }) > 0)
          variants.push_back(with_each({plain}, *splitting, {static_cast<double>(i)}).front());
    }
    std::erase_if(variants, [&](const SchemeConfig& choice) {
      return card.conflicts && !card.conflicts(choice.settings, problem_card).empty();
    });
    all.insert(all.end(), variants.begin(), variants.end());
  }
  return all;
}

}  // namespace

std::vector<SchemeConfig> suggested_candidates(const Scene& scene, const Keep& keep) {
  return candidates_by([&](const SchemeCard& card) { return suggested_settings(scene, card); }, *scene.mechanics, keep);
}
std::vector<SchemeConfig> catalogue_candidates(const Mechanics& mechanics, const Keep& keep) {
  return candidates_by([&](const SchemeCard& card) { return plain_settings(&mechanics.card(), card, nullptr); },
                       mechanics, keep);
}

ErrorStudy::ErrorStudy(const Request& scene, bool at_end, double seconds, const std::atomic<bool>& cancelled,
                       std::shared_ptr<const Conditioning> known)
    : scene_(scene), at_end_(at_end), cancelled_(cancelled), conditioning_(std::move(known)) {
  const Deadline deadline(seconds);
  const auto keep_going = [&] { return deadline.left() > 0 && !cancelled.load(std::memory_order_relaxed); };
  if (!conditioning_) conditioning_ = least::conditioning(*scene_.scene, scene_.end, keep_going);
  if (conditioning_->ends) scene_.end = conditioning_->reached;
  if (!at_end || scene_.norm == Norm::relative) {  // the relative norm needs component sizes along the whole motion
    constexpr int count = 256;                     // in long runs errors peak in every revolution
    const double span = scene_.end - scene_.scene->start;
    times_ = conditioning_->pace_in(scene_.norm);  // otherwise a fast passage would be missed
    for (int k = 1; k < count; ++k) times_.push_back(scene_.scene->start + span * k / count);
    std::ranges::sort(times_);
    const auto near = [&](double a, double b) { return b - a < 1e-9 * span; };
    times_.erase(std::unique(times_.begin(), times_.end(), near), times_.end());
    std::erase_if(times_, [&](double t) { return near(scene_.scene->start, t) || near(t, scene_.end); });
  }
  times_.push_back(scene_.end);
  truth_ = least::truth(*scene_.scene, times_, keep_going);
}

bool nothing_moves_in(const Scene& scene, const Conditioning& motion) {
  return scene.mechanics->text() && std::ranges::all_of(scene.initial, [](double x) { return x == 0; }) &&
         motion.complete && motion.size == 0;
}

double ErrorStudy::floor() const {
  const double rounding = 0x1p-53 * conditioning_->growth_in(scene_.norm, at_end_);
  return known() ? std::max(truth_->uncertainty_in(scene_.norm), rounding) : rounding;
}

Request ErrorStudy::request(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const {
  Request request = scene_;
  request.scheme = choice.scheme;
  request.settings = choice.settings;
  request.until_steps = false;
  request.record = {Record::Mode::every, 0, {}};
  request.columns.clear();
  request.measures = request.watched = {};
  request.events.clear();
  request.section.reset();
  request.diagnostics.clear();
  request.control = false;
  request.limits = {seconds, step_limit, 1'000'000};
  return request;
}

double ErrorStudy::longest(const SchemeConfig& choice, const ResolutionParameter& dial) const {
  if (dial.adaptive()) return dial.range.high;
  const double span = scene_.end - scene_.scene->start;
  if (!card(choice).own_clock) {
    // In units of the motion's time scale: states so far apart have nothing to do with each other
    constexpr double far = 1000;
    const double scale = scene_.scene->mechanics->scales(*scene_.scene).time;
    return std::min({span, dial.range.high, scale > 0 ? far * scale : span});
  }
  double value = dial.value(choice);
  for (int k = 0; k < 40; ++k, value /= 4) {  // where the first step fails, a shorter one may succeed
    const double left = deadline_ ? deadline_->left() : 1;
    if (!(left > 0) || cancelled_.load(std::memory_order_relaxed)) break;
    Request one = request(dial.at(choice, value), std::min(left, 1.0), 1);
    one.until_steps = true;
    one.steps = 1;
    one.probe = true;
    Samples none;
    const Solution outcome = scene_.scene->mechanics->run(one, none, cancelled_);
    if (outcome.stop.reason == ReturnCode::completed && outcome.t > scene_.scene->start)
      return std::min(value * (span / (outcome.t - scene_.scene->start)), dial.range.high);
  }
  return dial.value(choice);
}

Trial ErrorStudy::run(Request measured, const std::vector<double>& times, States& states) const {
  const std::size_t size = conditioning_->variables;
  if (!at_end_) {
    measured.record = {Record::Mode::times, 1, times};
    for (std::size_t i = 0; i < size; ++i) measured.columns.push_back(i + 1);
  }
  Samples samples;
  const Solution outcome = scene_.scene->mechanics->run(measured, samples, cancelled_);
  for (std::size_t i = 0; i + size <= samples.values.size(); i += size)
    states.emplace_back(samples.values.begin() + static_cast<std::ptrdiff_t>(i),
                        samples.values.begin() + static_cast<std::ptrdiff_t>(i + size));
  if (at_end_) states.emplace_back(outcome.final.begin(), outcome.final.begin() + static_cast<std::ptrdiff_t>(size));
  return {outcome.stop.reason, unknown, outcome.cost.force_evaluations, outcome.cost.seconds, false};
}

double ErrorStudy::error(const States& states, const States& truth, std::span<const double> sizes) const {
  if (states.empty() || truth.empty()) return unknown;
  if (at_end_) return state_error(states.back(), truth.back(), truth.back().size(), sizes);
  if (states.size() != truth.size()) return unknown;
  double most = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double here = state_error(states[i], truth[i], truth[i].size(), sizes);
    if (!(here <= most)) most = here;
    if (std::isnan(most)) break;
  }
  return most;
}

std::vector<double> ErrorStudy::sizes_along(const States& states) const {
  if (scene_.norm == Norm::absolute) return {};
  if (conditioning_->complete) return conditioning_->sizes;
  ComponentSizes sizes(kinds_of(scene_.scene->card()), conditioning_->variables);
  sizes.see(scene_.scene->initial);
  for (const auto& state : states) sizes.see(state);
  return sizes.divisors();
}

/// foreseen_error extrapolates from the last time at which the error is small, by the growth of differences from there
/// to the end; NaN where the error is never small.
double ErrorStudy::foreseen_error(const std::vector<double>& times, const States& states, const States& truth) const {
  constexpr double small = 0.03, parts = Conditioning::parts;
  const auto log_growth = [&](double eighths) {
    const auto before = static_cast<std::size_t>(std::min(eighths, parts - 1));
    const auto log_at = [&](std::size_t k) {
      return k > 0 ? std::log(conditioning_->so_far_in(scene_.norm)[k - 1]) : 0;
    };
    return std::lerp(log_at(before), log_at(before + 1), eighths - static_cast<double>(before));
  };
  double foreseen = unknown;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double here = state_error(states[i], truth[i], truth[i].size(), known_sizes());
    if (!(here < small)) break;
    const double eighths = parts * (times[i] - start()) / (end() - start());
    foreseen = here * std::exp(log_growth(parts) - log_growth(eighths));
  }
  return foreseen;
}

Trial ErrorStudy::run(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const {
  States states, finer;
  Trial trial = run(request(choice, seconds, step_limit), times_, states);
  if (trial.status != ReturnCode::completed) return trial;
  if (known()) {
    trial.error = error(states, truth_->states, known_sizes());
    return trial;
  }
  if (has_stand_in()) {
    trial.error = error(states, stand_in_, sizes_along(stand_in_));
    return trial;
  }
  const ResolutionParameter dial(card(choice));
  const double value = dial.value(choice) / (dial.adaptive() ? 100 : 2);
  const Trial half = run(request(dial.at(choice, value), seconds - trial.seconds, 2 * step_limit), times_, finer);
  trial.error = half.status == ReturnCode::completed ? error(states, finer, sizes_along(finer)) : unknown;
  return trial;
}

void ErrorStudy::let_stand_in(const SchemeConfig& choice, double seconds) {
  States states;
  const Trial trial = run(request(choice, seconds, scene_.limits.steps), times_, states);
  if (trial.status == ReturnCode::completed) stand_in_ = std::move(states);
}

Trial ErrorStudy::look(const SchemeConfig& choice, double seconds, std::int64_t step_limit, double accuracy) const {
  if (!known() || at_end_) return run(choice, seconds, step_limit);
  Request probe = request(choice, seconds, step_limit);
  probe.probe = true;
  Trial trial;
  for (const std::size_t apart : {48, 12}) {
    States truth, states;
    std::vector<double> times;
    for (std::size_t i = (times_.size() - 1) % apart; i < times_.size(); i += apart) {
      times.push_back(times_[i]);
      truth.push_back(truth_->states[i]);
    }
    trial = run(probe, times, states);
    if (trial.status != ReturnCode::completed) return trial;
    trial.error = error(states, truth, known_sizes());
    if (trial.error <= accuracy) return run(choice, seconds - trial.seconds, step_limit);
    if (!(trial.error < plateau())) {
      if (const double foreseen = foreseen_error(times, states, truth);
          conditioning_->chaotic(scene_.norm) && foreseen > trial.error) {
        trial.error = foreseen;
        trial.foreseen = true;
      }
      return trial;
    }
    probe.limits.seconds -= trial.seconds;
  }
  return trial;
}

double ErrorStudy::time(const SchemeConfig& choice, double seconds, std::int64_t step_limit) const {
  const Request timed = request(choice, seconds, step_limit);
  double together = 0, shortest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3 && together < 2e-3; ++k) {
    Samples none;
    const double here = scene_.scene->mechanics->run(timed, none, cancelled_).cost.seconds;
    shortest = std::min(shortest, here);
    together += here;
  }
  return shortest;
}

}  // namespace least
