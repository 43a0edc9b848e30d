#include "server/decode/further_faults.hpp"

#include <iterator>
#include <utility>
#include <variant>

#include "core/catalogue/custom.hpp"
#include "core/text/characters.hpp"
#include "core/text/text_reader.hpp"

namespace least::server {
namespace {

using text::Definition;
using text::DefinitionFault;

/// replace puts a number in the place of the faulty text; it returns whether that was possible.
bool replace(text::TypedScene& typed, const DefinitionFault& fault) {
  Definition& scene = typed.scene;
  const std::pair<const char*, Definition::Named*> all[] = {{"/definitions/", &typed.definitions},
                                                            {"/masses/", &scene.masses},
                                                            {"/equations/", &scene.equations},
                                                            {"/forces/", &scene.forces},
                                                            {"/invariants/", &scene.invariants}};
  for (const auto& [key, named] : all)
    for (auto entry = named->begin(); entry != named->end(); ++entry) {
      if (text::pointer_to(key, entry->first) != fault.pointer) continue;
      if (fault.in_text)
        entry->second = "1";
      else
        named->erase(entry);  // the name is at fault
      return true;
    }
  const std::pair<const char*, std::optional<std::string>*> single[] = {{"/damping", &scene.damping},
                                                                        {"/action_curvature", &scene.action_curvature},
                                                                        {"/offset", &scene.offset},
                                                                        {"/dissipation", &scene.dissipation}};
  for (const auto& [pointer, text] : single)
    if (fault.pointer == pointer) {
      if (fault.in_text)
        *text = "1";
      else
        text->reset();  // it has no place there
      return true;
    }
  if (scene.kind == Definition::Kind::equations ||
      fault.pointer != "/" + std::string(Definition::kind_names[static_cast<std::size_t>(scene.kind)]))
    return false;
  std::string simplest = simplest_formula(scene, scene.formula);
  if (scene.formula == simplest) return false;
  scene.formula = std::move(simplest);
  return true;
}

}  // namespace

std::string simplest_formula(const Definition& scene, std::string_view text) {
  const bool lagrangian = scene.kind == Definition::Kind::lagrangian;
  if (!lagrangian && scene.kind != Definition::Kind::hamiltonian) return "0";
  std::string formula;
  for (const std::string& variable : scene.variables) {
    const std::size_t bracket = variable.find('[');
    const bool many = bracket != variable.npos;
    const std::string of_one = variable.substr(0, bracket) + (many ? "[i]" : "");
    const std::string square = (lagrangian ? text::velocity_name(of_one) : text::momentum_name(of_one)) + "^2/2";
    formula += formula.empty() ? "" : " + ";
    formula +=
        many ? "sum(i=1.." + variable.substr(bracket + 1, variable.size() - bracket - 2) + ", " + square + ")" : square;
  }
  return text::speaks_of(text, "s") ? formula + (lagrangian ? " - s" : " + s") : formula;
}

FurtherFaults further_faults(text::TypedScene typed, std::vector<DefinitionFault> first) {
  constexpr int most_rounds = 4;
  std::vector<DefinitionFault> found = std::move(first);
  FurtherFaults further;
  for (int round = 0; round < most_rounds; ++round) {
    for (const DefinitionFault& fault : found)
      if (!replace(typed, fault)) return further;
    auto made = custom_mechanics(typed);
    auto* wrong = std::get_if<std::vector<DefinitionFault>>(&made);
    if (!wrong) {
      further.stand_in = std::get<std::shared_ptr<const Mechanics>>(std::move(made));
      return further;
    }
    found = std::move(*wrong);
    further.faults.insert(further.faults.end(), found.begin(), found.end());
  }
  return further;
}

}  // namespace least::server
