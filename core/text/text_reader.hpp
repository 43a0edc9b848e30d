// The texts of a definition: names that are checked, and formulas recorded on the tape of a form.
#pragma once

#include <memory>

#include "core/text/form.hpp"

namespace least::text {

/// `/equations/x`: names with what RFC 6901 makes of / and ~.
std::string pointer_to(std::string_view key, std::string_view name);

/// Collects what is wrong on the way.
class TextReader {
 public:
  explicit TextReader(const Definition& definition);

  void check_names();
  /// What names stand for in a text. `momentum`: the letter of what is known beside the coordinates, `p`, `v` or none;
  /// the others are refused with the reason. Good until it is called again.
  Words words(char momentum, std::string_view no_velocity, std::string_view no_momentum, std::string_view no_s);
  /// The forces beside the mechanics, whose form is known: core/text/forces.cpp.
  void read_forces();
  /// Nothing where the text is wrong, which is then known.
  std::optional<Symbol> record(const std::string& pointer, const std::string& text, const Words& known);

  void fault(std::string pointer, std::string detail, std::string allowed = {}) {
    faults_.push_back({std::move(pointer), {0, std::move(detail), std::move(allowed), {}}, false});
  }
  const std::vector<DefinitionFault>& faults() const { return faults_; }

 protected:
  std::size_t n() const { return form_->coordinates; }
  bool flow() const { return given_.kind == Definition::Kind::equations; }
  /// How many operations the texts may take.
  std::size_t operations() const { return given_.typed ? most_summed : most_operations; }

  const Definition& given_;
  std::shared_ptr<Form> form_;

 private:
  std::vector<DefinitionFault> faults_;
  std::vector<std::string> names_;
  std::size_t characters_ = 0, summed_ = 0;
};

}  // namespace least::text
