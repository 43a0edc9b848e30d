// Expressions of the caller's own over a scene: what further columns are, and what vanishes at events. They are read
// once and made ready together; a run gives them the numbers of a state.
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

/// An expression by its name: the card of the column that it is, and what was typed.
struct Measure {
  ColumnCard card;
  std::string text;
};

/// Expressions over the same scene. A value; what it says depends on the scene's parameters, which are constants of it.
struct Measures {
  std::vector<Measure> list;
  std::vector<bool> reads;  ///< which of the scene's variables, in the order of its card, and then whether the energy

  bool empty() const { return list.empty(); }
  std::size_t size() const { return list.size(); }
  /// Only a full state can say one of them.
  bool full_state() const;
  bool reads_energy() const { return !reads.empty() && reads.back(); }
  bool reads_variable(std::size_t i) const { return i + 1 < reads.size() && reads[i]; }

  /// values[i] of each, from what `observe` says of a state, and the time of the state. Any of them may be no finite
  /// number.
  void evaluate(const double* observed, double t, double* values) const;
  /// The same along a direction.
  void evaluate(const Slope* observed, const Slope& t, Slope* values) const;
  /// The same of all states within bounds, and of all times; with what changes by time where that is known, too.
  void enclose(const interval::Enclosure* observed, const interval::Enclosure& t, interval::Enclosure* values) const;
  void enclose(const interval::RateEnclosure* observed, const interval::RateEnclosure& t,
               interval::RateEnclosure* values) const;

 private:
  friend class MeasureReader;
  tape::Formula formula_;
};

/// Reads expressions over a scene, one after the other. They know its variables, `t`, the parameters that are numbers,
/// `energy` where the scene has one, and what every expression knows. Stays where it is.
class MeasureReader {
 public:
  /// The scene outlives it. `velocities`: they know those of the coordinates, too, where a scene as text has them:
  /// then what is observed has a velocity for each coordinate after the energy.
  explicit MeasureReader(const Scene& scene, bool velocities = false);
  MeasureReader(const MeasureReader&) = delete;
  MeasureReader& operator=(const MeasureReader&) = delete;

  /// What is wrong with the text, if anything: then it is left out.
  std::optional<text::Fault> read(std::string name, std::string text);
  /// The names that they may use, beside `pi`.
  std::vector<std::string_view> names() const;
  /// Those that were read, in their order.
  Measures made() const;

 private:
  const ProblemCard& card_;
  const text::TextScene* text_;  ///< the scene as it was typed; null where it was not
  tape::Tape tape_;
  std::vector<std::string> velocities_;  ///< their names
  text::Words words_;
  std::vector<tape::Index> outputs_;
  Measures measures_;
};

/// What measures are functions of: the variables of the scene's card, and its energy where one of them reads it.
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
