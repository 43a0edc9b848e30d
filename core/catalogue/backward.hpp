// Motion backward in time. With τ = −t, p̃ = −p and s̃ = −s the backward motion of a scene is the forward motion of
// another one: that of L̃(q, q′, τ, s̃) = L(q, −q′, −τ, −s̃), with H̃(q, p̃, τ, s̃) = H(q, −p̃, −τ, −s̃), or for
// equations that of ẏ = −f(y, −τ). So every scheme, its references and its diagnostics work backward unchanged, and a
// symmetric scheme retraces its steps. Source: Arnold, Mathematical Methods of Classical Mechanics, 1989, on reversible
// systems; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, V.1; with s by the substitution above in
// Herglotz's principle.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "core/run/mechanics.hpp"

namespace least {

/// backward returns the scene whose forward motion is the backward motion of this one, from the same state at the time
/// −start; variables, columns and expressions keep their names. For a problem of the catalogue it is a scene as text
/// with the domain, energy, local frequency, quantities and orbital elements of the problem
/// (core/catalogue/forward_table.hpp), but without its closed form and its sections. If there is no such scene, it
/// returns the reason in words.
std::variant<Scene, std::string> backward(const Scene& scene);

/// forward_of returns the scene that `backward` was given, or the scene itself if it goes forward.
const Scene& forward_of(const Scene& scene);
inline bool goes_backward(const Scene& scene) { return &forward_of(scene) != &scene; }

/// sign_of returns −1 for quantities that change sign in a scene that goes backward: times, rates by time, momenta and
/// s; else 1. `name` is that of a column, or of a part of a report.
double sign_of(const Scene& scene, std::string_view name);

/// TurnedRows converts the rows of a run that goes backward to the signs of its forward scene, and passes them to
/// `sink`.
class TurnedRows final : public RowSink {
 public:
  /// The arguments have to outlive it.
  TurnedRows(const Request& request, RowSink& sink);
  bool append(std::span<const double> rows) override { return sink_.append(turned(rows, signs_)); }
  bool append_section(std::span<const double> rows) override {
    return sink_.append_section(turned(rows, section_signs_));
  }
  bool progress(double t, std::int64_t steps) override { return sink_.progress(0 - t, steps); }

 private:
  std::span<const double> turned(std::span<const double> rows, const std::vector<double>& signs);

  RowSink& sink_;
  std::vector<double> signs_, section_signs_, turned_;
};

/// turn does the same to the solution of a run.
void turn(const Scene& scene, Solution& outcome);

}  // namespace least
