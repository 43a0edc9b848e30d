#include "server/http/admission.hpp"

#include <algorithm>
#include <cmath>

#include "server/http/metrics.hpp"

namespace least::server {
namespace {

// How often one who waits looks whether its client is still there.
constexpr std::chrono::milliseconds between_glances{50};

}  // namespace

std::optional<Admission::Pass> Admission::enter_besides(std::string_view name) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(name);
  const bool room = client != clients_.end() && running_ < places_ && waiting_ == 0 && !closed_;
  if (!room || client->second.running >= (places_ + 1) / 2) return std::nullopt;
  ++running_, ++client->second.running;
  return std::optional<Pass>(std::in_place, *this, client->first, false);
}

std::optional<Admission::Pass> Admission::enter(std::string_view name, std::chrono::milliseconds patience,
                                                const std::function<bool()>& gone) {
  const auto from = Clock::now();
  std::unique_lock lock(mutex_);
  const auto refused = [this] {
    if (metrics_) metrics_->rejected();
    return std::nullopt;
  };
  if (closed_) return refused();
  const auto client = clients_.try_emplace(std::string(name)).first;
  Client& own = client->second;
  Waiter waiter;
  if (running_ < places_ && waiting_ == 0) {
    waiter.admitted = true;
    ++running_, ++own.running;
  } else {
    const bool hopeless = expected_wait(own.waiting.size()) > std::chrono::duration<double>(patience).count();
    if (hopeless || (waiting_ >= queue_ && !make_room(own))) {
      forget(client);
      return refused();
    }
    if (own.waiting.empty()) turns_.push_back(client->first);
    own.waiting.push_back(&waiter);
    ++waiting_;
    admit_waiting();
    const auto called = [&] { return waiter.admitted || waiter.dismissed || closed_; };
    while (!called() && Clock::now() - from < patience) {
      if (waiter.woken.wait_for(lock, between_glances, called)) break;
      lock.unlock();  // looking takes a system call
      const bool left = gone && gone();
      lock.lock();
      if (left) break;
    }
    if (!waiter.admitted && !waiter.dismissed) {
      std::erase(own.waiting, &waiter);
      --waiting_;
      if (own.waiting.empty()) std::erase(turns_, client->first);
    }
  }
  if (!waiter.admitted) {
    if (!waiter.dismissed) forget(client);  // one that was dismissed may long have been forgotten
    return refused();
  }
  if (metrics_) metrics_->waited(std::chrono::duration<double>(Clock::now() - from).count());
  return std::optional<Pass>(std::in_place, *this, client->first);
}

void Admission::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (auto& [name, client] : clients_)
    for (Waiter* waiter : client.waiting) waiter->woken.notify_one();
}

Admission::Load Admission::load() const {
  const std::lock_guard lock(mutex_);
  return {running_, waiting_, running_ >= places_ && waiting_ >= queue_};
}

int Admission::retry_after() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::clamp(std::ceil(expected_wait(0)), 1.0, 60.0));
}

void Admission::leave(const std::string& name, std::optional<Clock::duration> took) {
  const double seconds = took ? std::chrono::duration<double>(*took).count() : 0;
  if (metrics_ && took) metrics_->ran(seconds);
  const std::lock_guard lock(mutex_);
  if (took) mean_ += 0.1 * (seconds - mean_);
  --running_;
  const auto client = clients_.find(name);
  --client->second.running;
  forget(client);
  admit_waiting();
}

// Gives free places to those who wait.
void Admission::admit_waiting() {
  while (running_ < places_ && !turns_.empty() && !closed_) {
    const auto turn = next();
    Client& client = clients_.find(*turn)->second;
    Waiter* const waiter = client.waiting.front();
    client.waiting.pop_front();
    if (client.waiting.empty()) {
      turns_.erase(turn);
    } else {
      turns_.splice(turns_.end(), turns_, turn);
    }
    --waiting_, ++running_, ++client.running;
    waiter->admitted = true;
    waiter->woken.notify_one();
  }
}

// Whose turn it is: the first of those who hold less than their share; where all have it, the first.
std::list<std::string>::iterator Admission::next() {
  const unsigned share = (places_ + 1) / 2;
  const auto entitled = std::find_if(turns_.begin(), turns_.end(), [&](const std::string& name) {
    return clients_.find(name)->second.running < share;
  });
  return entitled == turns_.end() ? turns_.begin() : entitled;
}

// Dismisses the last request of the client that has most in the queue, if that is more than the newcomer would have.
bool Admission::make_room(const Client& newcomer) {
  const auto most = std::max_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
    return a.second.waiting.size() < b.second.waiting.size();
  });
  auto& queue = most->second.waiting;
  if (queue.size() <= newcomer.waiting.size() + 1) return false;
  Waiter* const last = queue.back();
  queue.pop_back();
  --waiting_;
  last->dismissed = true;
  last->woken.notify_one();
  return true;
}

// In seconds, for one whose client has `own` requests waiting already: as many are served of every other before it.
double Admission::expected_wait(std::size_t own) const {
  if (running_ < places_ || places_ == 0) return 0;
  std::size_t ahead = 1;  // one of those who compute has to end
  for (const auto& name : turns_) ahead += std::min(clients_.find(name)->second.waiting.size(), own + 1);
  return static_cast<double>(ahead) * mean_ / places_;
}

void Admission::forget(Clients::iterator client) {
  if (client->second.running == 0 && client->second.waiting.empty()) clients_.erase(client);
}

}  // namespace least::server
