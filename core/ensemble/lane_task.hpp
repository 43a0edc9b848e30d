// What goes between an ensemble and the units of lanes, which are compiled for several instruction sets: numbers and
// pointers, and nothing that such a unit would compile for another.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/ensemble/lane_program.hpp"

namespace least {

/// The schemes that lanes know, by a position of their own: those of steps of equal length without equations to solve.
inline constexpr std::array<std::string_view, 9> lane_schemes{
    "explicit_euler", "explicit_midpoint",        "runge_kutta_4",    "ruth_3",           "symplectic_euler",
    "leapfrog",       "contact_symplectic_euler", "contact_leapfrog", "contact_splitting"};

/// The states within a step of a member.
class LanePath {
 public:
  virtual ~LanePath() = default;
  /// By a shorter step, as of a lone run; false: it fails. As many variables as the problem has.
  virtual bool at(double t, double* state) const = 0;
};

/// What the lanes ask of who gave them a task.
class LaneHost {
 public:
  virtual ~LaneHost() = default;
  /// (ωh)² from which on a step is unstable where the damping is α; infinite: never.
  virtual double turn_limit(double damping_step) = 0;
  /// The same question of a scene whose ω is the same everywhere.
  virtual bool is_too_fast(double turn_squared, double damping_step) = 0;
  /// A member's state at a time that was asked for, or before and after a step in which what is watched may have
  /// changed its sign, once or twice.
  virtual void at_time(std::size_t member, double t, const double* state) = 0;
  virtual void at_step(std::size_t member, double t_before, std::span<const double> before, double t,
                       std::span<const double> after) = 0;
  /// The path of a step that was asked for.
  virtual void look(const LanePath& path) = 0;
};

/// Members of one scene under one scheme, all from the same time on. Tables hold a row for each quantity with an entry
/// per member: entry m of row k stands at [k·count + m].
struct LaneTask {
  std::size_t scheme = 0;                ///< position among lane_schemes
  std::span<const double> settings;      ///< of the scheme
  std::span<const double> parameters;    ///< of the problem
  std::span<const std::size_t> varied;   ///< parameters of which each member has its own value
  const double* values = nullptr;        ///< table of those
  const LaneProgram* program = nullptr;  ///< in the place of a problem: the step of a scene as text
  const double* own = nullptr;           ///< table of the constants of the program that each member has of its own
  const double* start = nullptr;         ///< table of the variables
  std::size_t count = 0;
  bool full = false;  ///< s is carried where the scene has one

  double start_time = 0, step = 0, end = 0, tail = 0;
  std::int64_t steps = 0, step_limit = 0;
  std::span<const double> times;  ///< at which states are asked for, increasing
  bool watches = false;           ///< whether steps are told
  int watched = -1;               ///< only those in which this variable may pass the level; −1: all of them
  double level = 0;
  LaneHost* host = nullptr;
  const std::atomic<bool>* cancelled = nullptr;

  // The result.
  double* final = nullptr;        ///< table of the variables
  std::uint8_t* ended = nullptr;  ///< by member: ReturnCode; before, `cancelled` for all that are to be run
  std::int64_t taken = 0;         ///< steps of all members
  std::int64_t forces = 0;        ///< force evaluations of all members
  std::size_t variables = 0;      ///< rows of `final` that mean something
};

/// A state of a member, and where columns of it go.
struct LaneState {
  std::span<const double> parameters;  ///< of the problem
  bool full = false;                   ///< with s wherever the scene has one
  double t = 0;
  const double* values = nullptr;        ///< the variables
  std::span<const std::size_t> columns;  ///< of the card
  double* out = nullptr;
};
/// A step of a member whose path is asked for.
struct LaneStep {
  std::size_t scheme = 0;
  std::span<const double> settings, parameters;  ///< of the scheme, and of the problem
  double t = 0;
  std::span<const double> before;  ///< the variables at t; those that are not there are 0
};

/// Where a program is evaluated: t, h, the variables of the card, and the constants of one's own.
struct LanePoint {
  double t = 0, h = 0;
  const double *values = nullptr, *own = nullptr;
};

/// So many variables a state has that is run by a program; its tables have as many rows, in the order of the card.
inline constexpr std::size_t program_rows = 17;

/// What a unit of lanes can do with one problem, or with programs. The others are null in units that share parameters.
struct LaneMechanics {
  /// False: the pair cannot run in lanes, or not from this start, or not in this unit.
  bool (*run)(LaneTask& task) = nullptr;
  void (*columns)(const LaneState& state) = nullptr;
  /// Shows the path of the step to the host.
  void (*show)(const LaneStep& step, LaneHost& host) = nullptr;
  /// What the program makes of a point: its outputs, of one that makes steps the state and, where one can fail,
  /// whether it did.
  void (*evaluate)(const LaneProgram& program, const LanePoint& point, double* out) = nullptr;
};

}  // namespace least
