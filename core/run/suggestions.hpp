// What a request leaves out of a scheme's settings: the suggestions of the cards, brought to the units of the scene.
//
// Cards suggest steps for their own default scene, in natural units; a preset for the scene that it is. A suggestion is
// multiplied by how much longer (stronger, wider) the motion of the scene is than that one (core/run/scales.hpp). A
// factor that is not far from 1 is left out, so that an ordinary change of a parameter or of the start changes no
// default: one of time from 1/4 to 30, one of energy or length from 1/30 to 30. Scenes given as text have no default
// scene: they are compared with motions of frequencies from 1 to 3 and of a mass and a width of about 1. What was
// multiplied is rounded to three digits.
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
void adapt_to_units(const Scene& scene, const SchemeCard& scheme, const PresetCard* preset,
                    const std::vector<bool>& given, std::vector<double>& settings);
/// suggested_span returns the default length of a run: that of the cards, unless it is a thousand times too long or too
/// short for the motion of the scene.
double suggested_span(const Scene& scene, const PresetCard* preset);

}  // namespace least
