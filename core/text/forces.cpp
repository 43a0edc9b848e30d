// Forces beside a Lagrangian, a Hamiltonian or a potential: F(q, v, t), or F(q, p, t) beside a Hamiltonian, and −∂D/∂v
// of Rayleigh's function D(q, v, t). Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, 1.5.
#include <algorithm>

#include "core/tape/derivative.hpp"
#include "core/text/text_reader.hpp"

namespace least::text {
namespace {

/// objection_to_forces returns why no forces can stand beside such mechanics; empty where they can.
std::string objection_to_forces(const Definition& given, const Form& form) {
  if (form.kind == FormKind::flow) return "beside equations, which say all of the motion";
  if (given.damping) return "beside damping, which is a force of its own";
  if (given.action_curvature) return "beside action_curvature: no form would be kept";
  if (form.reads_action || form.kind == FormKind::contact_linear)
    return "beside an s in the mechanics: no form would be kept";
  if (form.kind == FormKind::lagrangian) return "beside a Lagrangian that is not quadratic in the velocities";
  return {};
}

}  // namespace

void TextReader::read_forces() {
  if (!given_.is_forced()) return;
  if (const std::string why = objection_to_forces(given_, *form_); !why.empty()) {
    return fault(given_.forces.empty() ? "/dissipation" : "/forces", "cannot stand " + why,
                 flow() ? "terms of the equations"
                        : "beside a potential, a Hamiltonian or a Lagrangian quadratic in the velocities, without s");
  }
  static constexpr std::string_view no_momenta = "is a momentum; here velocities are known",
                                    no_velocities = "is a velocity; forces beside a Hamiltonian know momenta",
                                    no_action = "is the action, on which no force depends";
  tape::Tape& tape = form_->tape;
  const bool momenta = given_.kind == Definition::Kind::hamiltonian;
  form_->forces.assign(n(), Symbol(0));
  form_->friction.assign(n(), Symbol(0));
  const auto known = words(momenta ? 'p' : 'v', no_velocities, no_momenta, no_action);
  const auto forces = texts_by_variable("/forces/", given_.forces, "the force on");
  for (std::size_t i = 0; i < n(); ++i)
    if (forces[i] != nullptr)
      if (const auto force = record(pointer_to("/forces/", given_.variables[i]), *forces[i], known))
        form_->forces[i] = *force;
  if (given_.dissipation)
    if (const auto d = record("/dissipation", *given_.dissipation, words('v', {}, no_momenta, no_action))) {
      std::vector<int> velocities;
      for (std::size_t i = 0; i < n(); ++i) velocities.push_back(form_->numbers.momentum + static_cast<int>(i));
      const auto slopes = tape::gradient(tape, *d, velocities);
      // A time-reversed scene has D̃(q, ṽ, τ) = D(q, −ṽ, −τ), so that −∂D/∂v is ∂D̃/∂ṽ.
      for (std::size_t i = 0; i < n(); ++i) form_->friction[i] = given_.backward ? slopes[i] : -slopes[i];
    }
  tape::Dependences depends(tape, [](int) { return tape::Dependence(0); });
  for (const auto* all : {&form_->forces, &form_->friction})
    for (const Symbol& force : *all) form_->autonomous = form_->autonomous && depends(force) == 0;
  form_->forced = true;
  form_->keeps_energy = false;
}

}  // namespace least::text
