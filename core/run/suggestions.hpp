// Defaults of a scheme's settings that a request leaves out: the suggestions of the cards, in the units of the scene.
//
// A card suggests steps for its own default scene, in natural units; a preset for its own scene. The suggestion is
// multiplied by the ratio of the characteristic times (energies, lengths) of the two motions (core/run/scales.hpp).
// Ratios near 1 are ignored, so that an ordinary change of a parameter or of the start changes no default: ratios of
// time from 1/4 to 30, of energy or length from 1/30 to 30. Scenes given as text have no default scene: they are
// compared with motions of frequencies from 1 to 3 and of a mass and a width of about 1. Products are rounded to three
// digits.
#pragma once

#include <vector>

#include "core/run/mechanics.hpp"
#include "core/run/scales.hpp"

namespace least {

/// suggested_settings returns all settings of a scheme for a scene, which may be that of a preset with changes.
std::vector<double> suggested_settings(const Scene& scene, const SchemeCard& scheme,
                                       const PresetCard* preset = nullptr);
/// plain_settings returns the settings as the cards suggest them, whatever the units of the scene.
std::vector<double> plain_settings(const ProblemCard* problem, const SchemeCard& scheme, const PresetCard* preset);
/// adapt_to_units scales those of `settings` that were not given to the units of the scene.
void adapt_to_units(const Scene& asked, const SchemeCard& scheme, const PresetCard* preset,
                    const std::vector<bool>& given, std::vector<double>& settings);
/// suggested_span returns the default length of a run: that of the cards, unless it is a thousand times too long or too
/// short for the motion of the scene.
double suggested_span(const Scene& asked, const PresetCard* preset);

}  // namespace least
