// A form whose tape has no kept sums.
#include "core/tape/derivative.hpp"
#include "core/text/form.hpp"

namespace least::text {

std::shared_ptr<const Form> with_sums_written_out(std::shared_ptr<const Form> form) try {
  if (!form->tape.has_terms()) return form;
  if (tape::operations_written_out(form->tape) > static_cast<std::size_t>(tape::most_written_out)) return nullptr;
  auto made = std::make_shared<Form>();
  made->kind = form->kind;
  made->autonomous = form->autonomous;
  made->keeps_energy = form->keeps_energy;
  made->reads_action = form->reads_action;
  made->constant_damping = form->constant_damping;
  made->forced = form->forced;
  made->coordinates = form->coordinates;
  made->numbers = form->numbers;
  made->full_mass = form->full_mass;
  made->invariant_names = form->invariant_names;
  made->tape.bound(tape::most_written_out);
  tape::Substitution write(
      form->tape, made->tape, [&](int i) { return Symbol::variable(made->tape, static_cast<std::size_t>(i)); },
      tape::Totals::written_out);
  constexpr Symbol Form::*single[] = {&Form::potential, &Form::damping,     &Form::action_curvature,
                                      &Form::offset,    &Form::hamiltonian, &Form::lagrangian};
  for (const auto part : single) (*made).*part = write((*form).*part);
  constexpr std::vector<Symbol> Form::*lists[] = {&Form::mass,   &Form::rates,    &Form::momenta,
                                                  &Form::forces, &Form::friction, &Form::invariants};
  for (const auto part : lists)
    for (const Symbol& y : (*form).*part) ((*made).*part).push_back(write(y));
  for (const auto part : {&Form::metric, &Form::hessian}) {
    const SymbolMatrix& from = (*form).*part;
    SymbolMatrix to(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
      for (const SymbolMatrix::Entry& entry : from.row(i)) to.row(i).push_back({entry.column, write(entry.value)});
    (*made).*part = std::move(to);
  }
  made->held.add_soon(made->tape.bytes());
  return made;
} catch (const tape::TooManyOperations&) {
  return nullptr;
}

}  // namespace least::text
