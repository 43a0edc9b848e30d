#include "core/run/mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/text/scene.hpp"

namespace least {

std::int64_t weight_of_force(const Mechanics& mechanics) {
  constexpr std::int64_t light = 1000;  // operations of the text and of derivatives for its form
  const text::TextScene* const scene = mechanics.text();
  return scene ? std::max<std::int64_t>(scene->form->tape.size() / light, 1) : 1;
}

const ProblemCard& Scene::card() const { return mechanics->card(); }

std::string Scene::key() const {
  std::string key(mechanics->key());
  const auto append = [&](std::span<const double> numbers) {  // as bits, so that NaN and −0 are distinct values
    const std::size_t count = numbers.size(), at = key.size();
    key.resize(at + sizeof count + count * sizeof(double));
    std::memcpy(key.data() + at, &count, sizeof count);
    if (count > 0) std::memcpy(key.data() + at + sizeof count, numbers.data(), count * sizeof(double));
  };
  key += '\0';
  append(parameters);
  append(initial);
  append({&start, 1});
  return key;
}

std::size_t Truth::bytes() const {
  std::size_t numbers = 0;
  for (const auto& state : states) numbers += state.size() + 3;  // a vector object has the size of three numbers
  return sizeof(Truth) + (numbers + sizes.size()) * sizeof(double);
}

bool Conditioning::chaotic(Norm norm) const {
  constexpr double far = 5;
  const auto& grown = so_far_in(norm);
  if (std::isinf(grown[7])) return true;
  return grown[7] > 1e6 && grown[7] > 30 * grown[3] && grown[5] > far * grown[3] && grown[7] > far * grown[5];
}

std::size_t Conditioning::bytes() const {
  return sizeof(Conditioning) + (pace.size() + relative_pace.size() + sizes.size()) * sizeof(double);
}

Truth truth_along(const Scene& scene, const std::vector<double>& times, Norm norm, const KeepGoing& keep_going) {
  if (norm == Norm::absolute || times.empty()) return scene.mechanics->truth(scene, times, keep_going);
  constexpr int evenly = 64;
  const double end = times.back();
  std::vector<double> all = times;
  for (int k = 1; k < evenly; ++k) all.push_back(std::lerp(scene.start, end, double(k) / evenly));
  for (const PaceMark& mark : scene.mechanics->pace(scene, end, keep_going))
    if (mark.t < end) all.push_back(mark.t);
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  Truth truth = scene.mechanics->truth(scene, all, keep_going);
  std::vector<std::vector<double>> asked;
  for (const double t : times) {
    const auto place = static_cast<std::size_t>(std::ranges::lower_bound(all, t) - all.begin());
    if (!(place < truth.states.size())) break;
    asked.push_back(truth.states[place]);
  }
  truth.states = std::move(asked);
  return truth;
}

}  // namespace least
