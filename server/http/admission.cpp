#include "server/http/admission.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/http/metrics.hpp"

namespace least::server {

Admission::Client& Admission::client_of(std::string_view name) {
  const auto client = clients_.try_emplace(std::string(name)).first;
  client->second.name = client->first;
  return client->second;
}

std::optional<Admission::Pass> Admission::admitted(Client& client, bool counts) noexcept {
  ++running_, ++client.running;
  if (!counts) ++besides_;
  return std::optional<Pass>(std::in_place, *this, client, counts);
}

std::optional<Admission::Pass> Admission::enter_besides(std::string_view name) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(name);
  const bool room = client != clients_.end() && running_ < places_ && waiting_ == 0 && !closed_;
  if (!room || client->second.running >= share_of(client->second)) return std::nullopt;
  return admitted(client->second, false);
}

bool Admission::gives_way(std::string_view name) const {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(name);
  return waiting_ > 0 || closed_ || (client != clients_.end() && client->second.running > share_of(client->second));
}

unsigned Admission::share_of(const Client& client) const {
  return running_ > client.running ? (places_ + 1) / 2 : places_;
}

std::optional<Admission::Pass> Admission::enter(std::string_view name) {
  const std::lock_guard lock(mutex_);
  if (closed_ || running_ >= places_ || waiting_ > 0) return std::nullopt;
  Client& client = client_of(name);
  if (metrics_) metrics_->waited(0);
  return admitted(client);
}

void Admission::wait(std::string_view name, std::chrono::milliseconds patience, std::function<bool()> gone, Turn turn) {
  const auto now = Clock::now();
  Waiters calls, newcomer;
  newcomer.push_back({now, now + patience, std::move(gone), std::move(turn)});
  Turns its_turn{nullptr};
  {
    const std::lock_guard lock(mutex_);
    Client& own = client_of(name);  // nothing is thrown from here on
    const bool room = running_ < places_ && waiting_ == 0;
    const bool hopeless = expected_wait(own.waiting.size()) > std::chrono::duration<double>(patience).count();
    if (closed_ || hopeless || (!room && waiting_ >= queue_ + besides_ && !make_room(own, calls))) {
      refuse(calls, newcomer, newcomer.begin());
      forget(own);
    } else {
      its_turn.front() = &own;
      if (own.waiting.empty()) turns_.splice(turns_.end(), its_turn);
      own.waiting.splice(own.waiting.end(), newcomer);
      ++waiting_;
      admit_waiting(calls);
    }
  }
  run(std::move(calls));
}

void Admission::look() {
  const auto now = Clock::now();
  Waiters calls;
  {
    const std::lock_guard lock(mutex_);
    for (auto turn = turns_.begin(); turn != turns_.end();) {
      Client& client = **turn;
      for (auto next = client.waiting.begin(); next != client.waiting.end();) {
        const auto waiter = next++;
        if (!closed_ && now < waiter->until && !(waiter->gone && waiter->gone())) continue;
        refuse(calls, client.waiting, waiter);
        --waiting_;
      }
      turn = client.waiting.empty() ? turns_.erase(turn) : std::next(turn);
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

void Admission::run(Waiters calls) noexcept {
  for (Waiter& call : calls) call.turn(std::move(call.pass));
}

void Admission::refuse(Waiters& calls, Waiters& from, Waiters::iterator waiter) noexcept {
  if (metrics_) metrics_->rejected();
  calls.splice(calls.end(), from, waiter);
}

Admission::Load Admission::load() const {
  const std::lock_guard lock(mutex_);
  return {running_, waiting_, running_ >= places_ && waiting_ >= queue_ + besides_};
}

int Admission::retry_after() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::clamp(std::ceil(expected_wait(0)), 1.0, 60.0));
}

void Admission::leave(Client& client, std::optional<Clock::duration> took, bool beside) noexcept {
  const double seconds = took ? std::chrono::duration<double>(*took).count() : 0;
  if (metrics_ && took) metrics_->ran(seconds);
  Waiters calls;
  {
    const std::lock_guard lock(mutex_);
    if (took) mean_ += 0.1 * (seconds - mean_);
    --running_, --client.running;
    if (beside) --besides_;
    forget(client);
    admit_waiting(calls);
  }
  run(std::move(calls));
}

// Gives free places to those who wait.
void Admission::admit_waiting(Waiters& calls) noexcept {
  while (running_ < places_ && !turns_.empty() && !closed_) {
    const auto turn = next();
    Client& client = **turn;
    calls.splice(calls.end(), client.waiting, client.waiting.begin());
    if (client.waiting.empty()) {
      turns_.erase(turn);
    } else {
      turns_.splice(turns_.end(), turns_, turn);
    }
    --waiting_;
    Waiter& waiter = calls.back();
    if (metrics_) metrics_->waited(std::chrono::duration<double>(Clock::now() - waiter.from).count());
    waiter.pass.emplace(*admitted(client));
  }
}

// Whose turn it is: the first of those who hold less than their share; where all have it, the first.
Admission::Turns::iterator Admission::next() {
  const unsigned share = (places_ + 1) / 2;
  const auto entitled =
      std::find_if(turns_.begin(), turns_.end(), [&](const Client* client) { return client->running < share; });
  return entitled == turns_.end() ? turns_.begin() : entitled;
}

// Dismisses the last request of the client that has most in the queue, if that is more than the newcomer would have.
bool Admission::make_room(const Client& newcomer, Waiters& calls) {
  const auto most = std::max_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
    return a.second.waiting.size() < b.second.waiting.size();
  });
  Waiters& queue = most->second.waiting;
  if (queue.size() <= newcomer.waiting.size() + 1) return false;
  refuse(calls, queue, std::prev(queue.end()));
  --waiting_;
  return true;
}

// In seconds, for one whose client has `own` requests waiting already: as many are served of every other before it.
double Admission::expected_wait(std::size_t own) const {
  if (running_ - besides_ + waiting_ < places_ || places_ == 0) return 0;
  std::size_t ahead = 1;  // one of those who compute has to end
  for (const Client* client : turns_) ahead += std::min(client->waiting.size(), own + 1);
  return static_cast<double>(ahead) * mean_ / places_;
}

void Admission::forget(const Client& client) {
  if (client.running == 0 && client.waiting.empty()) clients_.erase(clients_.find(client.name));
}

}  // namespace least::server
