// The run of a scheme of equal steps, and how it changes along one direction of its start and its parameters: the
// derivative of the scheme's own map, by dual numbers through its steps. Where a step solves equations, the derivative
// is that of the solution.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/run/request.hpp"
#include "core/run/save_schedule.hpp"
#include "core/variations/varied_problems.hpp"

namespace least::variations {

/// What is followed: all outlive the walk.
struct Walk {
  const Request& request;
  const SchemeCard& scheme;
  const Grid& grid;
  std::span<const double> start, slope;  ///< of the components: q, p, and s where the motion needs it
  std::span<const std::int64_t> looks;   ///< whole steps after which the state is wanted; they do not decrease
  const KeepGoing& keep_going;
};

/// States at the looks and at last at the end, and how they change.
struct Walked {
  std::vector<std::vector<double>> states, slopes;
  std::string reason;  ///< why it did not come to its end; empty: it did
};

/// Of a scene of this form; `moved`: the parameter that changes.
Walked walk(const Walk& on, const text::Form& form, std::span<const double> parameters,
            std::optional<std::size_t> moved);
/// Why there is none for a scheme and a form; empty: there is.
std::string no_walk(const SchemeCard& scheme, const text::Form& form);

/// Of one class of problem. No walk: whether there is one is the answer.
using WalkOf = std::optional<Walked> (*)(const Walk* on, std::string_view scheme,
                                         const std::shared_ptr<const VariedFormulas>& formulas);
/// The class for a form, and how many coordinates it has room for.
struct WalkClass {
  WalkOf walk = nullptr;
  std::size_t room = 0;
};

// Compiled on their own.
WalkClass walk_of_separable(bool full_mass);
WalkClass walk_of_damped(bool full_mass, bool constant);
WalkClass walk_of_quadratic(bool full_mass);
WalkClass walk_of_metric();
WalkClass walk_of_hamiltonian();
WalkClass walk_of_flow();
/// Of more coordinates than the others have room for.
WalkClass walk_of_large(const text::Form& form);

}  // namespace least::variations
