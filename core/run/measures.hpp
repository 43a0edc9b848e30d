// Expressions of the caller's own over a scene: further columns, and quantities whose zeros are events. They are parsed
// once and compiled together; a run evaluates them at its states.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "core/number/enclosure.hpp"
#include "core/run/problem_table.hpp"
#include "core/tape/formula.hpp"
#include "core/text/expression.hpp"

namespace least {

namespace text {
struct TextScene;
}

struct Scene;

/// Measure is a named expression: the card of its column, and its text.
struct Measure {
  ColumnCard card;
  std::string text;
};

/// Measures are expressions over the same scene, compiled together. The scene's parameters are constants in them.
struct Measures {
  std::vector<Measure> list;
  std::vector<bool> reads;  ///< whether they read each of the scene's variables, in the order of its card; then whether
                            ///< they read the energy

  bool empty() const { return list.empty(); }
  std::size_t size() const { return list.size(); }
  /// Whether one of them can only be evaluated at a full state.
  bool full_state() const;
  bool reads_energy() const { return !reads.empty() && reads.back(); }
  bool reads_variable(std::size_t i) const { return i + 1 < reads.size() && reads[i]; }

  /// evaluate writes the value of expression i to values[i]. `observed` is the result of `observe` at a state, t its
  /// time. Values may be not finite.
  void evaluate(const double* observed, double t, double* values) const;
  /// The same with derivatives along one direction.
  void evaluate(const Slope* observed, const Slope& t, Slope* values) const;
  /// The same for all states and times within bounds, with time derivatives in the second form.
  void enclose(const interval::Enclosure* observed, const interval::Enclosure& t, interval::Enclosure* values) const;
  void enclose(const interval::RateEnclosure* observed, const interval::RateEnclosure& t,
               interval::RateEnclosure* values) const;

 private:
  friend class MeasureReader;
  tape::Formula formula_;
};

/// MeasureReader parses expressions over a scene, one after the other. They may use its variables, `t`, the parameters
/// that are numbers, `energy` where the scene has one, and the functions and constants of every expression. It cannot
/// be copied.
class MeasureReader {
 public:
  /// The scene has to outlive the reader. `velocities`: expressions may also use the velocities of the coordinates, if
  /// the scene is given as text and has them; then `observed` has a velocity for each coordinate after the energy.
  explicit MeasureReader(const Scene& scene, bool velocities = false);
  MeasureReader(const MeasureReader&) = delete;
  MeasureReader& operator=(const MeasureReader&) = delete;

  /// Parses one expression; returns what is wrong with it, in which case it is left out.
  std::optional<text::Fault> read(std::string name, std::string text);
  /// The names that expressions may use, beside `pi`.
  std::vector<std::string_view> names() const;
  /// The expressions read so far, in their order.
  Measures made() const;

 private:
  const ProblemCard& card_;
  const text::TextScene* text_;  ///< the scene as given in text, else null
  tape::Tape tape_;
  std::vector<std::string> velocities_;  ///< their names
  text::Words words_;
  std::vector<tape::Index> outputs_;
  Measures measures_;
};

/// observe writes the arguments of measures: the variables of the scene's card, then its energy if one of them reads
/// it.
inline void observe(const ProblemTable& problem, StateView x, const Measures& measures, double* observed) {
  const std::size_t variables = measures.reads.size() - 1;
  for (std::size_t i = 0; i < variables; ++i) observed[i] = variable(problem.traits, x, i);
  if (measures.reads_energy() && problem.traits.full && problem.traits.has_energy)
    observed[variables] = problem.energy_of(x);
}
inline StateNumbers observe(const ProblemTable& problem, StateView x, const Measures& measures) {
  StateNumbers observed(measures.reads.size(), unknown);
  observe(problem, x, measures, observed.data());
  return observed;
}

}  // namespace least
