// The texts of a definition: names are checked, and formulas recorded on the tape of a form.
#pragma once

#include <memory>

#include "core/text/form.hpp"

namespace least::text {

/// pointer_to("/equations/", "x") returns `/equations/x`, with / and ~ in the name escaped as RFC 6901 says.
std::string pointer_to(std::string_view key, std::string_view name);

/// TextReader reads the texts of one definition and collects the faults that it finds.
class TextReader {
 public:
  explicit TextReader(const Definition& definition);

  void check_names();
  /// words(…) returns the names that a text may use and their symbols. `momentum` is 'p' or 'v', the kind of name that
  /// the text may use beside the coordinates, or another letter for neither; names of the other kind are refused with
  /// the given reason. Valid until the next call.
  Words words(char momentum, std::string_view no_velocity, std::string_view no_momentum, std::string_view no_s);
  /// read_forces() reads the forces beside the mechanics, once the form is known; see core/text/forces.cpp.
  void read_forces();
  /// record returns the symbol of a text; nothing where the text is wrong, and then the fault has been added.
  std::optional<Symbol> record(const std::string& pointer, const std::string& text, const Words& known);

  /// texts_by_variable returns the text of each variable, null where `texts` has none. Texts of no variable, and
  /// further ones of the same variable, are faults; `what` is "the force on", say, and `key` "/forces/".
  std::vector<const std::string*> texts_by_variable(std::string_view key, const Definition::Named& texts,
                                                    std::string_view what);

  void fault(std::string pointer, std::string detail, std::string allowed = {}) {
    faults_.push_back({std::move(pointer), {0, std::move(detail), std::move(allowed), {}}, false});
  }
  const std::vector<DefinitionFault>& faults() const { return faults_; }

 protected:
  std::size_t n() const { return form_->coordinates; }
  bool flow() const { return given_.kind == Definition::Kind::equations; }
  /// operations() returns the limit of operations for the texts together.
  std::size_t operations() const { return given_.typed ? most_summed : most_operations; }

  const Definition& given_;
  std::shared_ptr<Form> form_;

 private:
  std::vector<DefinitionFault> faults_;
  std::vector<std::string> names_;
  std::size_t characters_ = 0, summed_ = 0;
};

}  // namespace least::text
