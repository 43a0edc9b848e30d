#include "core/variations/parametric.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "core/catalogue/backward.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/schemes/held_program.hpp"
#include "core/tape/derivative.hpp"
#include "core/tape/elimination.hpp"
#include "core/text/scene.hpp"

namespace least::variations {
namespace {

using text::FormKind;

/// Writer writes the equations of a form on a tape of their own.
class Writer {
 public:
  /// `numbers` are the values of the parameters that are not varied.
  Writer(const text::Form& form, std::span<const double> numbers, const std::vector<bool>& varied, bool with_action,
         ParametricScene& made)
      : form_(form),
        numbers_(numbers),
        varied_(varied),
        with_action_(with_action),
        made_(made),
        rewrite_(form.tape, made.tape, [this](int i) { return variable_of_form(i); }) {}

  void write() {
    const std::size_t n = form_.coordinates;
    if (form_.kind == FormKind::flow) {
      made_.components = n;
      for (const Symbol& rate : form_.rates) made_.rates.push_back(rewrite_(rate));
      made_.energy = std::numeric_limits<double>::quiet_NaN();
      return;
    }
    made_.coordinates = n;
    made_.acting = form_.reads_action || (with_action_ && form_.kind == FormKind::contact_linear);
    made_.components = 2 * n + (made_.acting ? 1 : 0);
    const Symbol h = hamiltonian();
    std::vector<int> all(made_.components);
    std::iota(all.begin(), all.end(), 0);
    const std::vector<Symbol> slopes = tape::gradient(made_.tape, h, all);
    made_.action_slope = made_.acting ? slopes[2 * n] : rewrite_(form_.damping);
    made_.rates.resize(made_.components);
    Symbol work;
    for (std::size_t i = 0; i < n; ++i) {
      made_.rates[i] = slopes[n + i];
      made_.rates[n + i] = -slopes[i] - made_.action_slope * component(n + i);
      work += component(n + i) * slopes[n + i];
    }
    if (made_.acting) made_.rates[2 * n] = work - h;
    if (form_.forced) add_forces(std::vector<Symbol>(slopes.begin() + static_cast<std::ptrdiff_t>(n), slopes.end()));
    const bool undamped = made_.action_slope.is_constant() && made_.action_slope.constant() == 0;
    const bool says_all = made_.acting || form_.kind != FormKind::contact_linear || undamped;
    made_.energy = says_all ? h : Symbol(std::numeric_limits<double>::quiet_NaN());
    for (const Symbol& p : form_.momenta) made_.momenta.push_back(rewrite_(p));
  }

 private:
  Symbol component(std::size_t i) { return Symbol::variable(made_.tape, i); }

  Symbol variable_of_form(int i) {
    const text::Numbering& numbers = form_.numbers;
    const auto from = [](int k) { return static_cast<std::size_t>(k); };
    if (i >= numbers.parameter) {
      const std::size_t which = from(i - numbers.parameter);
      return varied_[which] ? component(made_.components + which) : Symbol(numbers_[which]);
    }
    if (form_.kind == FormKind::flow || i < numbers.momentum) return component(from(i));
    return component(i == numbers.action ? 2 * made_.coordinates : made_.coordinates + from(i - numbers.momentum));
  }

  /// hamiltonian() returns H; where the motion of a contact scene does not need s, without the terms with s.
  Symbol hamiltonian() {
    if (form_.kind == FormKind::hamiltonian) return rewrite_(form_.hamiltonian);
    const std::size_t n = made_.coordinates;
    std::vector<Symbol> velocity;
    for (std::size_t i = 0; i < n; ++i) velocity.push_back(component(n + i));
    const bool inverse_known = form_.full_mass && form_.momenta.empty();
    if (!form_.metric.empty() || form_.full_mass) {
      std::vector<Symbol> matrix;
      const text::SymbolMatrix& given = form_.metric.empty() ? form_.hessian : form_.metric;
      for (const Symbol& entry : given.written_out()) matrix.push_back(rewrite_(entry));
      if (inverse_known) {
        const std::vector<Symbol> p = velocity;
        for (std::size_t i = 0; i < n; ++i) {
          velocity[i] = Symbol(0);
          for (std::size_t j = 0; j < n; ++j) velocity[i] += matrix[i * n + j] * p[j];
        }
      } else {
        tape::eliminate(matrix, velocity);
      }
    } else {
      for (std::size_t i = 0; i < n; ++i) velocity[i] = velocity[i] / rewrite_(form_.mass[i]);
    }
    Symbol twice_kinetic;
    for (std::size_t i = 0; i < n; ++i) twice_kinetic += component(n + i) * velocity[i];
    Symbol h = Symbol(0.5) * twice_kinetic + rewrite_(form_.potential);
    if (form_.kind == FormKind::contact_linear && made_.acting) h += rewrite_(form_.damping) * component(2 * n);
    if (form_.kind == FormKind::contact_quadratic) {
      const Symbol s = component(2 * n);
      h += Symbol(0.5) * rewrite_(form_.action_curvature) * (s * s) - rewrite_(form_.offset);
    }
    return h;
  }

  /// add_forces adds the forces to ṗ. Texts of forces read velocities, unless a Hamiltonian was given.
  void add_forces(const std::vector<Symbol>& velocity) {
    tape::Substitution with_velocities(form_.tape, made_.tape, [&](int i) {
      const text::Numbering& numbers = form_.numbers;
      const bool moves = i >= numbers.momentum && i < numbers.momentum + static_cast<int>(form_.coordinates);
      return moves ? velocity[static_cast<std::size_t>(i - numbers.momentum)] : variable_of_form(i);
    });
    made_.forced = true;
    for (std::size_t i = 0; i < form_.coordinates; ++i) {
      const Symbol typed = form_.momenta.empty() ? rewrite_(form_.forces[i]) : with_velocities(form_.forces[i]);
      Symbol& rate = made_.rates[form_.coordinates + i];
      rate = rate + typed + with_velocities(form_.friction[i]);
    }
  }

  const text::Form& form_;
  std::span<const double> numbers_;
  const std::vector<bool>& varied_;
  bool with_action_;
  ParametricScene& made_;
  tape::Substitution rewrite_;
};

/// The Taylor program of equations without varied parameters.
tape::Program program_of(ParametricScene& scene) {
  std::vector<tape::Index> rates;
  for (const Symbol& rate : scene.rates) rates.push_back(rate.on(scene.tape));
  return taylor::program_of(scene.tape, rates, rates.size());
}

}  // namespace

std::variant<std::shared_ptr<const ParametricScene>, std::string> parametric_scene(const Scene& scene,
                                                                                   const std::vector<bool>& varied,
                                                                                   bool with_action) {
  const text::TextScene* const text = scene.mechanics->text();
  const Scene& forward = forward_of(scene);
  std::shared_ptr<const text::Form> form;
  if (!forward.mechanics->text()) {
    form = recorded_in_parameters(forward, varied, goes_backward(scene));
  } else {
    form = text::with_sums_written_out(text->form);
    if (!form) return "its sums have more terms than derivatives are taken of";
  }
  if (!form) return "this problem is none whose equations can be differentiated";
  if (form->kind == FormKind::lagrangian)
    return "a Lagrangian that is not quadratic in the velocities has no derivatives yet";
  auto made = std::make_shared<ParametricScene>();
  made->parameters = scene.parameters;
  if (const auto& cards = forward.card().parameters; made->parameters.size() != cards.size())
    made->parameters = forward.parameters;
  Writer(*form, made->parameters, varied, with_action, *made).write();
  const std::size_t n = made->coordinates;
  const std::size_t capacity = text ? static_cast<std::size_t>(text->capacity) : n;
  for (std::size_t i = 0; i < made->components; ++i) {
    const std::size_t place = n == 0 || i < n ? i : i == 2 * n ? 2 * capacity : capacity + i - n;
    made->variables.push_back(place);
    made->signs.push_back(text && text->turns(place) ? -1 : 1);
  }
  made->form = form;
  made->backward = goes_backward(scene);
  made->varied = varied;
  constexpr std::size_t few = 24;  // components; larger scenes do not use precomputed steps
  if (!text && !made->backward) {
    const auto equations = [&](const std::vector<bool>& by) {
      auto program = recorded_equations(forward, by);
      return program && program->moving == made->components ? std::move(program) : std::nullopt;
    };
    made->motion = equations(std::vector<bool>(varied.size(), false));
    made->varied_motion = equations(varied);
  } else if (const std::vector<bool> none(varied.size(), false); varied != none && made->components <= few) {
    ParametricScene numbers;
    Writer(*form, made->parameters, none, with_action, numbers).write();
    made->motion = program_of(numbers);
  }
  return std::shared_ptr<const ParametricScene>(std::move(made));
}

}  // namespace least::variations
