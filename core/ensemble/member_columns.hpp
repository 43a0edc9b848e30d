// Columns of an ensemble: columns of the scene's card, and expressions of the request, in which varied quantities are
// variables like any other. They are compiled once for all members and give the same bits on every machine.
#pragma once

#include <memory>
#include <span>

#include "core/ensemble/lane_compiler.hpp"
#include "core/ensemble/members.hpp"

namespace least {

/// MemberReader reads expressions over the members of an ensemble, one after the other. Not movable.
class MemberReader {
 public:
  /// Scene and variations must outlive it.
  MemberReader(const Scene& scene, std::span<const Variation> vary);
  MemberReader(const MemberReader&) = delete;
  MemberReader& operator=(const MemberReader&) = delete;

  /// read returns what is wrong with the text, which is then left out; nothing where it is right.
  std::optional<text::Fault> read(std::string name, std::string text);
  /// names() returns the names that expressions may use, besides `pi`.
  std::vector<std::string_view> names() const;
  /// made() returns the expressions that were read, in order; they do not refer to the states of a single run.
  const Measures& made() const { return measures_; }

 private:
  friend class MemberColumns;
  const ProblemCard& card_;
  const text::TextScene* text_;  ///< the scene, where it was given as text; else null
  tape::Tape tape_;              ///< its variables: the columns of the card, then the parameters that vary
  text::Words words_;
  std::vector<tape::Index> outputs_;
  Measures measures_;
};

/// MemberColumns computes the columns of an ensemble from columns of the card.
class MemberColumns {
 public:
  /// The columns and measures of `request` must be readable by MemberReader.
  MemberColumns(const Request& request, std::span<const Variation> vary);

  /// needed() returns the columns of the card, at least one, from which all requested columns follow; runs of members
  /// record these.
  const std::vector<std::size_t>& needed() const { return needed_; }
  std::size_t size() const { return columns_.size(); }
  /// fill writes the requested columns: from the needed ones, the time, and the varied parameters in the order of the
  /// variations. Values that do not exist are NaN.
  void fill(const double* needed, double t, std::span<const double> varied, double* out) const;

 private:
  void compile(const MemberReader& reader);

  std::vector<std::size_t>
      columns_;  ///< by requested column: its place in `needed_`, or behind these the number of the expression
  std::vector<std::size_t> needed_;
  std::size_t own_ = 0;
  std::shared_ptr<const CompiledLanes> lanes_;  ///< the compiled expressions, if there are any
};

}  // namespace least
