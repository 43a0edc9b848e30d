// The result of a run, and the receiver of its samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/run/message.hpp"
#include "core/status.hpp"

namespace least {

/// Report is a tree of named results, so that a new diagnostic needs no new code in an encoder. Non-finite numbers
/// stand for unknown values and are written as null.
struct Report {
  using Value = std::variant<std::monostate, double, bool, std::string, std::vector<double>, std::vector<Report>>;
  std::string key;
  Value value;
};

/// numbers returns a result that consists of several numbers with names.
Report numbers(std::string_view key, std::initializer_list<std::pair<std::string_view, double>> parts);
/// words returns a text, null if it is empty.
Report words(std::string_view key, std::string_view text);
/// insert puts a part into a result that has parts, before the part at `place` or at the end.
void insert(Report& report, std::size_t place, Report part);

/// Receives blocks of samples as they are computed.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// rows: whole rows in row-major order, one number per column asked for. False ends the run as cancelled.
  virtual bool append(std::span<const double> rows) = 0;
  /// The same for rows of the request's section_columns().
  virtual bool append_section([[maybe_unused]] std::span<const double> rows) { return true; }
  /// Called a few times a second with how far the run got. False ends the run as cancelled.
  virtual bool progress([[maybe_unused]] double t, [[maybe_unused]] std::int64_t steps) { return true; }
};

/// Keeps all samples in memory, row-major.
class Samples final : public RowSink {
 public:
  bool append(std::span<const double> rows) override {
    values.insert(values.end(), rows.begin(), rows.end());
    return true;
  }
  std::vector<double> values;
};

struct Termination {
  ReturnCode reason = ReturnCode::completed;
  Message detail;
  double t = 0;           ///< last good time
  std::int64_t step = 0;  ///< last good step
  std::optional<double> singular_at;
};

struct Warning {
  std::string_view code;
  Message detail;
};

struct Cost {
  std::int64_t steps = 0, force_evaluations = 0, iterations = 0;
  double seconds = 0;
};

struct Solution {
  Termination stop;                 ///< reason completed: the run reached its end
  double t = 0;                     ///< time of the final state
  std::vector<double> final;        ///< in the order of the problem's variables
  std::vector<Report> diagnostics;  ///< one entry per diagnostic asked for
  std::vector<Report> events;       ///< each a list: t, kind, …
  std::vector<Report> acts;         ///< for each event that acted: name, count, keeps, defect (Acts::reports)
  std::string event;                ///< name of the caller's event that ended the run; empty: none did
  std::int64_t event_count = 0;     ///< how often that event has acted; 0: it does not act
  std::vector<Warning> warnings;
  Cost cost;
  Held held = HeldByThread::take(0);  ///< memory of the events, of which there may be many

  /// Throws MemoryShortage.
  void add_event(Report report);
  /// Adds one more part to the last event; throws MemoryShortage.
  void extend_event(Report part);
};

}  // namespace least
