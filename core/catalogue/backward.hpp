// Motion backward in time. With τ = −t, p̃ = −p and s̃ = −s a scene moved backward is another scene moved forward: that
// of L̃(q, q′, τ, s̃) = L(q, −q′, −τ, −s̃), with H̃(q, p̃, τ, s̃) = H(q, −p̃, −τ, −s̃), or of ẏ = −f(y, −τ). So every
// scheme, its references and its diagnostics go backward as they are, and a symmetric scheme retraces its steps.
// Source: Arnold, Mathematical Methods of Classical Mechanics, 1989, on reversible systems; Hairer, Lubich, Wanner,
// Geometric Numerical Integration, 2006, V.1; with s by the substitution above in Herglotz's principle.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "core/run/mechanics.hpp"

namespace least {

/// The scene that moves forward as this one moves backward, from the same state at the time −start; its variables,
/// columns and expressions have the names of this one. Of a problem of the catalogue it is a scene as text, which has
/// its domain, energy, quantities and orbital elements (core/catalogue/forward_table.hpp), and neither its closed forms
/// nor what it finds at sections of its own. Or why there is none, in words.
std::variant<Scene, std::string> backward(const Scene& scene);

/// The scene as it was asked for: what `backward` was given, or the scene itself.
const Scene& forward_of(const Scene& scene);
inline bool goes_backward(const Scene& scene) { return &forward_of(scene) != &scene; }

/// −1 for what changes its sign where the scene goes backward: times, rates by time, momenta and s; else 1. `name`: of
/// a column, or of a part of a report.
double sign_of(const Scene& scene, std::string_view name);

/// Rows of a run that goes backward, told in the time of its forward scene.
class TurnedRows final : public RowSink {
 public:
  /// All outlive it.
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

/// And what it left behind.
void turn(const Scene& scene, Solution& outcome);

}  // namespace least
