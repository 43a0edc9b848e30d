#include "server/http/admission.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/http/metrics.hpp"

namespace least::server {

std::optional<Admission::Pass> Admission::enter_besides(std::string_view name) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(name);
  const bool room = client != clients_.end() && running_ < places_ && waiting_ == 0 && !closed_;
  if (!room || client->second.running >= (places_ + 1) / 2) return std::nullopt;
  ++running_, ++client->second.running;
  return std::optional<Pass>(std::in_place, *this, client->first, false);
}

std::optional<Admission::Pass> Admission::enter(std::string_view name) {
  const std::lock_guard lock(mutex_);
  if (closed_ || running_ >= places_ || waiting_ > 0) return std::nullopt;
  const auto client = clients_.try_emplace(std::string(name)).first;
  ++running_, ++client->second.running;
  if (metrics_) metrics_->waited(0);
  return std::optional<Pass>(std::in_place, *this, client->first);
}

void Admission::wait(std::string_view name, std::chrono::milliseconds patience, std::function<bool()> gone, Turn turn) {
  const auto now = Clock::now();
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    const auto client = clients_.try_emplace(std::string(name)).first;
    Client& own = client->second;
    const bool room = running_ < places_ && waiting_ == 0;
    const bool hopeless = expected_wait(own.waiting.size()) > std::chrono::duration<double>(patience).count();
    if (closed_ || hopeless || (!room && waiting_ >= queue_ && !make_room(own, calls))) {
      refuse(calls, std::move(turn));
      forget(client);
    } else {
      if (own.waiting.empty()) turns_.push_back(client->first);
      own.waiting.push_back({now, now + patience, std::move(gone), std::move(turn)});
      ++waiting_;
      admit_waiting(calls);
    }
  }
  run(std::move(calls));
}

void Admission::look() {
  const auto now = Clock::now();
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    calls.reserve(waiting_);  // nothing is thrown from here on
    for (auto turn = turns_.begin(); turn != turns_.end();) {
      const auto client = clients_.find(*turn);
      std::erase_if(client->second.waiting, [&](Waiter& waiter) {
        if (!closed_ && now < waiter.until && !(waiter.gone && waiter.gone())) return false;
        refuse(calls, std::move(waiter.turn));
        --waiting_;
        return true;
      });
      turn = client->second.waiting.empty() ? turns_.erase(turn) : std::next(turn);
      forget(client);
    }
  }
  run(std::move(calls));
}

void Admission::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  look();
}

void Admission::run(Calls calls) {
  for (Call& call : calls) call.turn(std::move(call.pass));
}

void Admission::refuse(Calls& calls, Turn turn) {
  if (metrics_) metrics_->rejected();
  calls.push_back({std::move(turn), std::nullopt});
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
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    if (took) mean_ += 0.1 * (seconds - mean_);
    --running_;
    const auto client = clients_.find(name);
    --client->second.running;
    forget(client);
    admit_waiting(calls);
  }
  run(std::move(calls));
}

// Gives free places to those who wait.
void Admission::admit_waiting(Calls& calls) {
  while (running_ < places_ && !turns_.empty() && !closed_) {
    const auto turn = next();
    const auto found = clients_.find(*turn);
    Client& client = found->second;
    Waiter waiter = std::move(client.waiting.front());
    client.waiting.pop_front();
    if (client.waiting.empty()) {
      turns_.erase(turn);
    } else {
      turns_.splice(turns_.end(), turns_, turn);
    }
    --waiting_, ++running_, ++client.running;
    if (metrics_) metrics_->waited(std::chrono::duration<double>(Clock::now() - waiter.from).count());
    calls.push_back({std::move(waiter.turn), std::optional<Pass>(std::in_place, *this, found->first)});
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
bool Admission::make_room(const Client& newcomer, Calls& calls) {
  const auto most = std::max_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
    return a.second.waiting.size() < b.second.waiting.size();
  });
  auto& queue = most->second.waiting;
  if (queue.size() <= newcomer.waiting.size() + 1) return false;
  refuse(calls, std::move(queue.back().turn));
  queue.pop_back();
  --waiting_;
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
