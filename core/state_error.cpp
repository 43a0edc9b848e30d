#include "core/state_error.hpp"

#include <string>
#include <string_view>

#include "core/describe.hpp"

namespace least {
namespace {

/// without_index returns x for x[3], x3 and x_3.
std::string_view without_index(std::string_view name) {
  if (const std::size_t bracket = name.find('['); bracket != name.npos) return name.substr(0, bracket);
  std::size_t length = name.size();
  while (length > 1 && name[length - 1] >= '0' && name[length - 1] <= '9') --length;
  if (length > 1 && length < name.size() && name[length - 1] == '_') --length;
  return name.substr(0, length);
}

bool is_place(std::string_view name) { return name == "x" || name == "y" || name == "z"; }

/// kind_of returns a text that is the same for all names of one kind.
std::string kind_of(std::string_view name) {
  const std::string_view base = without_index(name);
  if (is_place(base)) return "x";
  const bool prefixed = base.size() == 2 && (base[0] == 'p' || base[0] == 'v');
  return prefixed && is_place(base.substr(1)) ? std::string{base[0], 'x'} : std::string(base);
}

}  // namespace

std::vector<std::size_t> kinds_of(const ProblemCard& card) {
  std::vector<std::string> kinds;
  std::vector<std::size_t> first;
  for (const VariableCard& variable : card.variables) {
    kinds.push_back(kind_of(variable.name));
    first.push_back(static_cast<std::size_t>(std::ranges::find(kinds, kinds.back()) - kinds.begin()));
  }
  return first;
}

}  // namespace least
