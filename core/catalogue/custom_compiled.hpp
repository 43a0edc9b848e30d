// Scenes as text of one class of problem, as mechanics.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/catalogue/compiled.hpp"
#include "core/text/scene.hpp"
#include "core/text/scenes.hpp"

namespace least {

template <class P>
class CustomMechanics final : public ProblemMechanics<P> {
 public:
  /// Throws TooManyOperations where its equations of motion take more than those of a scene may.
  explicit CustomMechanics(text::TextScene scene)
      : ProblemMechanics<P>(scene.described()), scene_(std::move(scene)), key_(scene_.definition.key()) {
    std::vector<double> parameters;
    for (const auto& parameter : scene_.definition.parameters) parameters.push_back(parameter.second);
    tape::Tape equations;
    equations.bound(tape::most_of_equations);
    taylor::write_equations<StateOf<P>>(problem_of(parameters), equations);
  }

  std::string_view key() const override { return key_; }
  const text::TextScene* text() const override { return &scene_; }
  Scales scales(const Scene& scene) const override {
    return scales_.of(scene.key(), [&] { return ProblemMechanics<P>::scales(scene); });
  }

 private:
  /// What was asked for last. A search asks for the same again and again, and what a large text comes to takes
  /// milliseconds.
  template <class Key, class Value>
  class Last {
   public:
    template <class Make>
    Value of(const Key& key, Make&& make) {
      {
        const std::lock_guard lock(mutex_);
        if (known_ && known_->first == key) return known_->second;
      }
      Value made = make();
      const std::lock_guard lock(mutex_);
      known_.emplace(key, made);
      return made;
    }

   private:
    std::mutex mutex_;
    std::optional<std::pair<Key, Value>> known_;
  };

  P problem_of(std::span<const double> parameters) const override {
    P problem;
    problem.formulas = formulas_.of({parameters.begin(), parameters.end()},
                                    [&] { return std::make_shared<const text::Formulas>(*scene_.form, parameters); });
    return problem;
  }

  text::TextScene scene_;
  std::string key_;
  mutable Last<std::string, Scales> scales_;
  mutable Last<std::vector<double>, std::shared_ptr<const text::Formulas>> formulas_;
};

}  // namespace least
