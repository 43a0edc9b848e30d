#include "server/decode/further_faults.hpp"

#include <iterator>
#include <memory>
#include <utility>
#include <variant>

#include "core/catalogue/custom.hpp"
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
      text->reset();
      return true;
    }
  if (fault.pointer != "/potential") return false;
  scene.formula = "0";
  return true;
}

}  // namespace

std::vector<DefinitionFault> further_faults(text::TypedScene typed, std::vector<DefinitionFault> first) {
  constexpr int most_rounds = 4;
  std::vector<DefinitionFault> found = std::move(first), all;
  for (int round = 0; round < most_rounds; ++round) {
    for (const DefinitionFault& fault : found)
      if (!replace(typed, fault)) return all;
    const auto made = custom_mechanics(typed);
    const auto* wrong = std::get_if<std::vector<DefinitionFault>>(&made);
    if (!wrong) break;
    found = *wrong;
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

}  // namespace least::server
