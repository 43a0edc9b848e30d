// Scenes as text of one class of problem, as mechanics.
#pragma once

#include "core/catalogue/compiled.hpp"
#include "core/text/scene.hpp"
#include "core/text/scenes.hpp"

namespace least {

template <class P>
class CustomMechanics final : public ProblemMechanics<P> {
 public:
  explicit CustomMechanics(text::TextScene scene)
      : ProblemMechanics<P>(scene.described()), scene_(std::move(scene)), key_(scene_.definition.key()) {}

  std::string_view key() const override { return key_; }
  const text::TextScene* text() const override { return &scene_; }

 private:
  P problem_of(std::span<const double> parameters) const override {
    P problem;
    problem.formulas = std::make_shared<const text::Formulas>(*scene_.form, parameters);
    return problem;
  }

  text::TextScene scene_;
  std::string key_;
};

}  // namespace least
