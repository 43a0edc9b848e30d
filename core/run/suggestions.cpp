#include "core/run/suggestions.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/text/scene.hpp"

namespace least {
namespace {

/// named returns the value of that name; empty if there is none, or it is NaN.
std::optional<double> named(const std::vector<NamedValue>& values, std::string_view name) {
  const auto found = std::ranges::find(values, name, &NamedValue::first);
  return found == values.end() || std::isnan(found->second) ? std::nullopt : std::optional(found->second);
}

/// card_scene returns the scene that cards and presets speak of: of one that goes backward the forward one.
const Scene& card_scene(const Scene& scene) {
  const text::TextScene* const text = scene.mechanics->text();
  return text && text->forward ? *text->forward : scene;
}

/// own_scene returns the scene that the suggestions were made for.
Scene own_scene(const Scene& scene, const PresetCard* preset) {
  const ProblemCard& card = scene.card();
  Scene own{scene.mechanics, {}, {}, 0};
  for (const auto& parameter : card.parameters) own.parameters.push_back(parameter.value);
  for (const auto& variable : card.variables) own.initial.push_back(variable.value);
  if (preset == nullptr) return own;
  const auto take = [](const auto& cards, const std::vector<NamedValue>& values, std::vector<double>& into) {
    for (std::size_t i = 0; i < cards.size(); ++i) {
      const auto found = std::ranges::find(values, cards[i].name, &NamedValue::first);
      if (found != values.end()) into[i] = found->second;
    }
  };
  take(card.parameters, preset->parameters, own.parameters);
  take(card.variables, preset->initial, own.initial);
  own.start = named(preset->initial, "t").value_or(0);
  return own;
}

/// ratio returns here/there, or 1 where it is between `least` and `most`, or unknown.
double ratio(double here, double there, double least, double most) {
  const double ratio = here / there;
  return ratio > 0 && std::isfinite(ratio) && !(ratio >= least && ratio <= most) ? ratio : 1;
}

struct Comparison {
  Scales here, there;
};
/// compare returns the scales of the scene, and of the scene that a suggestion was made for: that of the card if
/// `of_card`, else the one that defaults of schemes assume.
Comparison compare(const Scene& scene, const PresetCard* preset, bool of_card) {
  constexpr Scales typed{.time = 0.6, .energy = 0.5, .length = 0.5};
  if (!of_card) return {scene.mechanics->scales(scene), typed};
  const Scene own = own_scene(scene, preset);
  if (own.parameters == scene.parameters && own.initial == scene.initial && own.start == scene.start) return {};
  return {scene.mechanics->scales(scene), scene.mechanics->scales(own)};
}

double rounded(double x) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), x, std::chars_format::scientific, 2).ptr;
  double value = x;
  std::from_chars(digits.begin(), end, value);
  return value;
}

/// factor returns what a setting of this name is multiplied by. Steps are shortened sooner than lengthened: a step that
/// is too short only costs time, one that is too long costs the run.
double factor(const Comparison& scales, std::string_view name, const SchemeCard& scheme,
              const std::vector<double>& settings) {
  constexpr double shorter = 0.25, least = 1.0 / 30, most = 30;
  const auto& [here, there] = scales;
  const double time = ratio(here.time, there.time, shorter, most);
  const double energy = ratio(here.energy, there.energy, least, most);
  if (name == "step") return time;
  if (name == "theta") return ratio(here.length, there.length, least, most);
  if (name == "critical_kinetic_energy" || name == "unit_energy") return energy;
  if (name != "sigma") return 1;
  const auto exponent = scheme.find("exponent");  // dt = (K + κ)ᵏ⁻¹ dτ, with k = 0 if nothing is damped
  const double power = here.damped && exponent ? 1 - settings[*exponent] : 1;
  return time * std::pow(energy, power);
}

}  // namespace

std::vector<double> plain_settings(const ProblemCard* problem, const SchemeCard& scheme, const PresetCard* preset) {
  std::vector<double> settings;
  for (const auto& parameter : scheme.parameters) {
    std::optional<double> value;
    if (preset != nullptr) value = named(preset->suggested, parameter.suggested);
    if (problem != nullptr && !value) value = named(problem->suggested, parameter.suggested);
    settings.push_back(value.value_or(parameter.value));
  }
  return settings;
}

void adapt_to_units(const Scene& asked, const SchemeCard& scheme, const PresetCard* preset,
                    const std::vector<bool>& given, std::vector<double>& settings) {
  const Scene& scene = card_scene(asked);
  std::array<std::optional<Comparison>, 2> scales;  // at index `of_card`
  for (std::size_t i = 0; i < scheme.parameters.size(); ++i) {
    const ParameterCard& parameter = scheme.parameters[i];
    if (given[i] || parameter.suggested.empty() || !std::isfinite(settings[i])) continue;
    const bool of_card = !scene.mechanics->text() || named(scene.card().suggested, parameter.suggested) ||
                         (preset && named(preset->suggested, parameter.suggested));
    auto& known = scales[of_card ? 1 : 0];
    if (!known) known = compare(scene, preset, of_card);
    const double by = factor(*known, parameter.suggested, scheme, settings);
    const double value = by == 1 ? settings[i] : rounded(by * settings[i]);
    if (parameter.range.contains(value)) settings[i] = value;
  }
}

std::vector<double> suggested_settings(const Scene& scene, const SchemeCard& scheme, const PresetCard* preset) {
  std::vector<double> settings = plain_settings(&card_scene(scene).card(), scheme, preset);
  adapt_to_units(scene, scheme, preset, std::vector<bool>(settings.size(), false), settings);
  return settings;
}

double suggested_span(const Scene& asked, const PresetCard* preset) {
  const Scene& scene = card_scene(asked);
  constexpr double far = 1000;
  const double span = preset && preset->span > 0 ? preset->span : scene.card().span;
  const text::TextScene* const text = scene.mechanics->text();
  const auto [here, there] = compare(scene, preset, text == nullptr || text->known);
  const double by = ratio(here.time, there.time, 1 / far, far);
  return by == 1 ? span : rounded(by * span);
}

}  // namespace least
