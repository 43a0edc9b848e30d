#include "core/run/mechanics.hpp"

#include <cmath>
#include <cstring>

namespace least {

const ProblemCard& Scene::card() const { return mechanics->card(); }

std::string Scene::key() const {
  std::string key(mechanics->key());
  const auto append = [&](std::span<const double> numbers) {  // bits: NaN and −0 are themselves
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
  for (const auto& state : states) numbers += state.size() + 3;  // a vector is as large as three
  return sizeof(Truth) + numbers * sizeof(double);
}

bool Conditioning::chaotic() const {
  constexpr double far = 5;
  if (std::isinf(so_far[7])) return true;
  return so_far[7] > 1e6 && so_far[7] > 30 * so_far[3] && so_far[5] > far * so_far[3] && so_far[7] > far * so_far[5];
}

std::size_t Conditioning::bytes() const { return sizeof(Conditioning) + pace.size() * sizeof(double); }

}  // namespace least
