// The cards of problems and schemes that requests are held against and answers are written from.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/run/mechanics.hpp"
#include "server/shared/json_writer.hpp"

namespace least::server {

struct Cards {
  std::span<const std::shared_ptr<const Mechanics>> problems;
  std::span<const SchemeCard> schemes;
};

/// The card of `auto`, with all parameters but `keep`, which is a list. The core knows no such scheme; it is chosen
/// before a run.
const SchemeCard& auto_card();

/// What `keep` may ask for.
inline constexpr std::array<std::string_view, 3> keep_names{"energy", "structure", "momenta"};

/// How an error may be asked for, in the order of Norm.
inline constexpr std::array<std::string_view, 2> norm_names{"absolute", "relative"};

/// A parameter's value the way a request spells it: choices by name, flags as booleans, NaN as null or the card's word
/// for it.
void write_parameter(JsonWriter& json, const ParameterCard& card, double value);
/// The same of the i-th setting of a scheme: also {"weights": […], "order": …} of a composition of one's own.
void write_setting(JsonWriter& json, const SchemeCard& card, std::span<const double> settings, std::size_t i);

}  // namespace least::server
