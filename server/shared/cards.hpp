// The cards of problems and schemes, against which requests are checked and from which answers are written.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/run/mechanics.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

/// Cards are the problems and schemes that a service offers.
struct Cards {
  std::span<const std::shared_ptr<const Mechanics>> problems;
  std::span<const SchemeCard> schemes;
};

/// auto_card() returns the card of `auto`, with all parameters but `keep`, which is a list. The core has no such
/// scheme; it is replaced before a run.
const SchemeCard& auto_card();

/// The values of `keep`.
inline constexpr std::array<std::string_view, 3> keep_names{"energy", "structure", "momenta"};

/// The names of norms in requests, in the order of Norm.
inline constexpr std::array<std::string_view, 2> norm_names{"absolute", "relative"};

/// write_parameter writes a parameter's value as a request spells it: choices by name, flags as booleans, NaN as null
/// or the card's word for it.
void write_parameter(JsonWriter& json, const ParameterCard& card, double value);
/// write_setting does the same for the i-th setting of a scheme; a custom composition becomes {"weights": […], "order":
/// …}.
void write_setting(JsonWriter& json, const SchemeCard& card, std::span<const double> settings, std::size_t i);

}  // namespace least::server
