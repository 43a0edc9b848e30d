// Columns of an ensemble: those of the scene's card, and expressions of the caller's own, in which what varies from
// member to member is a variable like any other. They are read and made ready once for all members, and say the same on
// every machine.
#pragma once

#include <memory>
#include <span>

#include "core/ensemble/lane_compiler.hpp"
#include "core/ensemble/members.hpp"

namespace least {

/// Reads expressions over the members of an ensemble, one after the other. Stays where it is.
class MemberReader {
 public:
  /// Scene and variations outlive it.
  MemberReader(const Scene& scene, std::span<const Variation> vary);
  MemberReader(const MemberReader&) = delete;
  MemberReader& operator=(const MemberReader&) = delete;

  /// What is wrong with the text, if anything: then it is left out.
  std::optional<text::Fault> read(std::string name, std::string text);
  /// The names that they may use, beside `pi`.
  std::vector<std::string_view> names() const;
  /// Those that were read, in their order; they say nothing of the states of a single run.
  const Measures& made() const { return measures_; }

 private:
  friend class MemberColumns;
  const ProblemCard& card_;
  const text::TextScene* text_;  ///< the scene as it was typed; null where it was not
  tape::Tape tape_;              ///< variables: the columns of the card, then the parameters that vary
  text::Words words_;
  std::vector<tape::Index> outputs_;
  Measures measures_;
};

class MemberColumns {
 public:
  /// `request`: its columns and measures, which MemberReader can read.
  MemberColumns(const Request& request, std::span<const Variation> vary);

  /// Columns of the card, at least one, from which all that is asked for follows: what runs of members are asked for.
  const std::vector<std::size_t>& needed() const { return needed_; }
  std::size_t size() const { return columns_.size(); }
  /// out[k] of each column that is asked for, from those needed, the time, and those parameters that vary, in the order
  /// of the variations. What does not exist is unknown.
  void fill(const double* needed, double t, std::span<const double> varied, double* out) const;

 private:
  void compile(const MemberReader& reader);

  std::vector<std::size_t>
      columns_;  ///< of those asked for: the place among those needed, or behind them which own one
  std::vector<std::size_t> needed_;
  std::size_t own_ = 0;
  std::shared_ptr<const CompiledLanes> lanes_;  ///< where there are expressions
};

}  // namespace least
