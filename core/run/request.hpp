// One run, decoded and checked: what the core is asked to do.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "core/run/measures.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

/// Which states are kept.
struct Record {
  enum class Mode { every, samples, times, curve };
  Mode mode = Mode::every;
  /// every: the stride in steps, 0 keeps nothing; samples, curve: how many, both ends, uniform in time or in arc
  std::int64_t count = 1;
  std::vector<double> times;  ///< times: increasing, within the span
};

/// Budgets. A run that meets one ends with a status and keeps what it has.
struct Limits {
  double seconds = 10;
  std::int64_t steps = 100'000'000;
  std::int64_t samples = 5'000'000;  ///< numbers kept at most, rows × columns
};

struct Act;

/// What is looked for in an expression: zeros where it rises (1), falls (−1) or both (0), and whether one ends the run,
/// or what it does to the state.
struct EventAsked {
  int direction = 0;
  bool stop = false;
  std::shared_ptr<const Act> act{};
};
inline constexpr std::size_t most_events = 16;
/// With the expression of a section.
inline constexpr std::size_t most_watched = most_events + 1;
inline constexpr std::array<std::string_view, 3> event_directions{"up", "down", "both"};

/// Where a run is looked at beside its samples, and rows of the same columns are kept: at the times phase + k·period
/// after the start, or where an expression vanishes, which then is the first that the request watches.
struct Section {
  bool plane = false;
  double period = 0, phase = 0;  ///< of the run's own time
};

struct Request {
  std::shared_ptr<const Scene> scene;
  std::size_t scheme = 0;        ///< index among the schemes
  std::vector<double> settings;  ///< the scheme's parameters, in the order of its card
  bool until_steps = false;      ///< the end is given by a number of steps, else by a time
  double end = 0;
  std::int64_t steps = 0;
  Record record;
  Norm norm = Norm::absolute;  ///< of every error that is asked for
  /// Positions among the problem card's columns; beyond them, one after the other, among `measures`.
  std::vector<std::size_t> columns;
  Measures measures;                     ///< columns of the caller's own
  std::vector<std::size_t> diagnostics;  ///< indices into the problem card's diagnostics
  Measures watched;                      ///< the plane of a section, and events of the caller's own: their zeros
  std::vector<EventAsked> events;        ///< one for each
  std::optional<Section> section{};
  Limits limits;
  /// Rows that limits.samples leaves room for.
  std::int64_t most_rows() const {
    return limits.samples / std::max<std::int64_t>(static_cast<std::int64_t>(columns.size()), 1);
  }
  /// Whether it is the plane of the section, of what is watched.
  bool is_plane(std::size_t which) const { return which == 0 && section && section->plane; }
  /// What a row of the section holds: the time, which is the first of a problem's columns, and the columns asked for.
  std::vector<std::size_t> section_columns() const {
    std::vector<std::size_t> all{0};
    std::ranges::copy_if(columns, std::back_inserter(all), [](std::size_t place) { return place != 0; });
    return all;
  }
  /// The card of one of `columns`.
  const ColumnCard& column(std::size_t place) const {
    const auto& known = scene->card().columns;
    return place < known.size() ? known[place] : measures.list.at(place - known.size()).card;
  }
  /// The scheme's setting of that name; NaN where it has none.
  double setting(std::string_view name, const SchemeCard& card) const {
    const auto at = card.find(name);
    return at ? settings[*at] : std::numeric_limits<double>::quiet_NaN();
  }
  bool control = false;  ///< afterwards a second, short run by another scheme, and a warning where they disagree
  /// Of a search, which wants a rough answer soon: stability is looked at roughly, and nothing is said of why a run
  /// ends or against it.
  bool probe = false;
};

}  // namespace least
