// The starts of the members of an ensemble. Where a scene's start is given by velocities, members share these, and each
// has the momenta that follow from its own parameters and coordinates.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/ensemble/ensemble.hpp"
#include "core/tape/formula.hpp"

namespace least {

/// MemberStarts computes the starts of the members of one plan.
class MemberStarts {
 public:
  /// The plan must outlive it.
  explicit MemberStarts(const EnsemblePlan& plan);

  /// find sets parameters and start of the i-th member, in the order of the card.
  void find(std::int64_t i, std::vector<double>& parameters, std::vector<double>& initial) const;
  /// scene(i) returns the scene of the i-th member.
  std::shared_ptr<const Scene> scene(std::int64_t i) const;

 private:
  const EnsemblePlan& plan_;
  /// the common start with velocities, where momenta differ between members; else empty
  std::vector<double> in_velocities_;
  /// Momenta as functions of velocities, where all members have the same parameters
  std::optional<tape::Formula> momenta_;
};

}  // namespace least
