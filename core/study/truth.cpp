// Caches of reference solutions and conditionings, for the next question about the same motion.
#include <algorithm>
#include <list>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "core/study/study.hpp"

namespace least {
namespace {

/// question returns the cache key: the content of the scene and the bits of the times.
std::string question(const Scene& scene, std::span<const double> times) {
  std::string key = scene.key();
  key.append(reinterpret_cast<const char*>(times.data()), times.size_bytes());
  return key;
}

/// Cache keeps the answers used last. Thread-safe.
template <class Answer>
class Cache {
 public:
  std::shared_ptr<const Answer> find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(entries_, key, &Entry::key);
    if (found == entries_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found);
    return found->answer;
  }
  void keep(std::string key, std::shared_ptr<const Answer> answer, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    bytes += key.size();
    if (bytes > most_bytes) return;
    std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
    entries_.push_front({std::move(key), std::move(answer), bytes});
    std::size_t together = 0, count = 0;
    const auto first_too_many = std::ranges::find_if(entries_, [&](const Entry& entry) {
      together += entry.bytes;
      return ++count > most_entries || together > most_bytes;
    });
    entries_.erase(first_too_many, entries_.end());
  }

 private:
  static constexpr std::size_t most_entries = 64, most_bytes = 16 << 20;
  struct Entry {
    std::string key;
    std::shared_ptr<const Answer> answer;
    std::size_t bytes;
  };
  std::mutex mutex_;
  std::list<Entry> entries_;
};

/// answer returns the cached answer, or compute(keep_going); an answer that was given up is not cached.
template <class Answer, class Compute>
std::shared_ptr<const Answer> answer(Cache<Answer>& cache, std::string key, const KeepGoing& keep_going,
                                     Compute&& compute) {
  if (auto known = cache.find(key)) return known;
  bool gave_up = false;
  auto found = std::make_shared<const Answer>(compute([&] {
    gave_up = gave_up || !keep_going();
    return !gave_up;
  }));
  if (!gave_up) cache.keep(std::move(key), found, found->bytes());
  return found;
}

}  // namespace

std::shared_ptr<const Truth> truth(const Scene& scene, const std::vector<double>& times, const KeepGoing& keep_going) {
  static Cache<Truth> cache;
  return answer(cache, question(scene, times), keep_going,
                [&](const KeepGoing& going) { return scene.mechanics->truth(scene, times, going); });
}

std::shared_ptr<const Conditioning> conditioning(const Scene& scene, double end, const KeepGoing& keep_going) {
  static Cache<Conditioning> cache;
  return answer(cache, question(scene, {&end, 1}), keep_going,
                [&](const KeepGoing& going) { return scene.mechanics->conditioning(scene, end, going); });
}

}  // namespace least
