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

/// Record says which states a run keeps.
struct Record {
  enum class Mode { every, samples, times, curve };
  Mode mode = Mode::every;
  /// Mode `every`: the stride in steps, 0 keeps nothing. `samples` and `curve`: the number of samples with both ends,
  /// uniform in time or in arc length.
  std::int64_t count = 1;
  std::vector<double> times;  ///< for mode `times`: increasing, within the span
};

/// Limits of a run. A run that reaches one ends with a status and keeps what it has.
struct Limits {
  double seconds = 10;
  std::int64_t steps = 100'000'000;
  std::int64_t samples = 5'000'000;  ///< largest number of numbers kept, rows × columns
};

struct Act;

/// EventAsked says which zeros of an expression are events: where it rises (1), falls (−1) or both (0), and whether one
/// ends the run, or what it does to the state.
struct EventAsked {
  int direction = 0;
  bool stop = false;
  std::shared_ptr<const Act> act{};
};
inline constexpr std::size_t most_events = 16;
/// Events, and the expression of a section.
inline constexpr std::size_t most_watched = most_events + 1;
inline constexpr std::array<std::string_view, 3> event_directions{"up", "down", "both"};

/// Section is a Poincaré section: rows of the request's columns that are kept beside the samples, either at the times t
/// = phase + k·period later than the start, or (plane) where an expression vanishes, the first one that the request
/// watches.
struct Section {
  bool plane = false;
  double period = 0, phase = 0;  ///< in the time of the run
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
  /// Indices into the problem card's columns; larger ones continue in `measures`.
  std::vector<std::size_t> columns;
  Measures measures;                     ///< columns of the caller's own
  std::vector<std::size_t> diagnostics;  ///< indices into the problem card's diagnostics
  Measures watched;  ///< expressions whose zeros are searched: the plane of a section, then events of the caller's own
  std::vector<EventAsked> events;  ///< one for each of `watched`
  std::optional<Section> section{};
  Limits limits;
  std::size_t uncounted = 0;  ///< how many columns, the last ones, limits.samples does not count
  /// The number of rows that limits.samples leaves room for.
  std::int64_t most_rows() const {
    return limits.samples / std::max<std::int64_t>(static_cast<std::int64_t>(columns.size() - uncounted), 1);
  }
  /// The number of points of the section that limits.samples leaves room for: a point takes one number for the time and
  /// one for each other column. 0 where there is no section.
  std::int64_t most_points() const { return section ? limits.samples / std::ssize(section_columns()) : 0; }
  /// Whether this one of `watched` is the plane of the section.
  bool is_plane(std::size_t which) const { return which == 0 && section && section->plane; }
  /// The columns of a row of the section: the time, which is the first of a problem's columns, then the columns asked
  /// for.
  std::vector<std::size_t> section_columns() const {
    std::vector<std::size_t> all{0};
    std::ranges::copy_if(columns, std::back_inserter(all), [](std::size_t place) { return place != 0; });
    return all;
  }
  /// The card of a column, by an index as in `columns`.
  const ColumnCard& column(std::size_t place) const {
    const auto& known = scene->card().columns;
    return place < known.size() ? known[place] : measures.list.at(place - known.size()).card;
  }
  /// The scheme's setting of that name; NaN where it has none.
  double setting(std::string_view name, const SchemeCard& card) const {
    const auto at = card.find(name);
    return at ? settings[*at] : std::numeric_limits<double>::quiet_NaN();
  }
  bool control = false;  ///< add a short run by another scheme afterwards, and a warning where the two disagree
  /// For runs of a search, which needs a rough answer soon: stability is checked roughly, and the run gives no reasons
  /// for its end and no warnings.
  bool probe = false;
};

}  // namespace least
