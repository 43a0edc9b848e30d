// Where the members of an ensemble start. Of a scene whose start is in velocities each member has these, and the
// momenta that its own parameters and coordinates make of them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/ensemble/ensemble.hpp"
#include "core/tape/formula.hpp"

namespace least {

class MemberStarts {
 public:
  /// Of the members of a plan, which outlives this.
  explicit MemberStarts(const EnsemblePlan& plan);

  /// Parameters and start of the i-th member, in the order of the card.
  void find(std::int64_t i, std::vector<double>& parameters, std::vector<double>& initial) const;
  /// Its scene.
  std::shared_ptr<const Scene> scene(std::int64_t i) const;

 private:
  const EnsemblePlan& plan_;
  std::vector<double> in_velocities_;     ///< the common start, where momenta differ from member to member; else empty
  std::optional<tape::Formula> momenta_;  ///< of velocities, where all members have the same parameters
};

}  // namespace least
