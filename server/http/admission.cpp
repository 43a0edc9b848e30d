#include "server/http/admission.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <iterator>

#include "server/http/metrics.hpp"

namespace least::server {
namespace {

constexpr double fading = 30;      // seconds after which a second of computing counts 1/e
constexpr double a_while = 0.1;    // seconds
constexpr double forgetful = 0.1;  // weight of the latest run in a mean

}  // namespace

Admission::Admission(unsigned places, unsigned queue, Metrics* metrics, std::function<Clock::time_point()> now)
    : places_(places), queue_(queue), metrics_(metrics), now_(std::move(now)), free_(places) {
  ends_.reserve(places);
}

void Admission::Pass::excuse() {
  const std::lock_guard lock(admission_->mutex_);
  place_->counts = false;
}
void Admission::Pass::may_take(double seconds) {
  const std::lock_guard lock(admission_->mutex_);
  place_->limit = seconds;
}
bool Admission::Pass::parked() const {
  const std::lock_guard lock(admission_->mutex_);
  return place_->parked;
}
Admission::Ticket Admission::Pass::ticket() const { return {place_, place_->number}; }

Admission::Client& Admission::client_of(std::string_view address) {
  const auto client = clients_.try_emplace(std::string(address)).first;
  client->second.name = client->first;
  return client->second;
}

Admission::Pass Admission::admitted(Client& client, AccountPtr account, bool beside) noexcept {
  used_.splice(used_.end(), free_, free_.begin());
  Place& place = used_.back();
  place = Place{&client, std::move(account), ++last_, !beside, beside};
  place.since = now_();
  place.self = std::prev(used_.end());
  ++running_, ++client.running;
  if (beside) ++besides_;
  return {*this, place};
}

std::optional<Admission::Pass> Admission::enter_besides(std::string_view address) {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(address);
  const bool room = client != clients_.end() && running_ < places_ && waiting_ == 0 && !closed_;
  if (!room || client->second.running >= share_of(client->second)) return std::nullopt;
  return admitted(client->second, nullptr, true);
}

bool Admission::gives_way(std::string_view address) const {
  const std::lock_guard lock(mutex_);
  const auto client = clients_.find(address);
  return waiting_ > 0 || closed_ || (client != clients_.end() && client->second.running > share_of(client->second));
}

unsigned Admission::share_of(const Client& client) const {
  return running_ > client.running ? (places_ + 1) / 2 : places_;
}

std::optional<Admission::Pass> Admission::enter(const AccountPtr& account) {
  const std::lock_guard lock(mutex_);
  if (closed_ || running_ >= places_ || waiting_ > 0) return std::nullopt;
  Client& client = client_of(account->address());
  introduce(*account, client, now_());
  if (metrics_) metrics_->waited(0);
  return admitted(client, account);
}

void Admission::wait(const AccountPtr& account, std::chrono::milliseconds most, std::function<bool()> gone, Turn turn) {
  const auto now = now_();
  Waiters calls, newcomer;
  newcomer.push_back({account, 0, now, now + most, std::move(gone), std::move(turn)});
  Turns its_turn{nullptr};
  {
    const std::lock_guard lock(mutex_);
    Client& own = client_of(account->address());  // nothing throws from here on
    introduce(*account, own, now);
    const double rank = newcomer.front().rank = account->rank_;
    const bool room = running_ < places_ && waiting_ == 0;
    const bool hopeless = expected_wait(&own, rank, now) > std::chrono::duration<double>(most).count();
    if (closed_ || hopeless || (!room && queued() >= queue_ + besides_ && !make_room(own, rank, calls))) {
      refuse(calls, newcomer, newcomer.begin());
      forget(own);
    } else {
      line_up(own, newcomer, its_turn);
      admit_waiting(calls);
    }
  }
  run(std::move(calls));
}

// Behind those waiters of its client whose connections have computed no more.
void Admission::line_up(Client& client, Waiters& newcomer, Turns& its_turn) noexcept {
  its_turn.front() = &client;
  if (client.waiting.empty()) turns_.splice(turns_.end(), its_turn);
  auto at = client.waiting.end();
  while (at != client.waiting.begin() && std::prev(at)->rank > newcomer.front().rank) --at;
  client.waiting.splice(at, newcomer);
  ++waiting_;
}

void Admission::look() {
  const auto now = now_();
  Waiters calls;
  {
    const std::lock_guard lock(mutex_);
    // When a place is expected to become free
    double soonest = running_ < places_ ? 0 : std::numeric_limits<double>::infinity();
    for (const Place& place : used_)
      if (!place.parked) soonest = std::min(soonest, told_left(place, now));
    if (used_.empty()) soonest = 0;
    for (auto turn = turns_.begin(); turn != turns_.end();) {
      Client& client = **turn;
      for (auto next = client.waiting.begin(); next != client.waiting.end();) {
        const auto waiter = next++;
        const bool hopeless = soonest > std::chrono::duration<double>(waiter->until - now).count();
        if (!closed_ && !hopeless && now < waiter->until && !(waiter->gone && waiter->gone())) continue;
        if (waiter->resumes) --resuming_;
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
  if (metrics_ && !waiter->resumes) metrics_->rejected();
  calls.splice(calls.end(), from, waiter);
}

Admission::Load Admission::load() const {
  const std::lock_guard lock(mutex_);
  return {running_, queued(), parked_, running_ >= places_ && queued() >= queue_ + besides_};
}

int Admission::retry_after(const AccountPtr& account) const {
  constexpr double most = 3600;
  const std::lock_guard lock(mutex_);
  const auto client = account ? clients_.find(account->address()) : clients_.end();
  const double wait =
      expected_wait(client == clients_.end() ? nullptr : &client->second, account ? account->rank_ : 0, now_());
  return static_cast<int>(std::clamp(std::ceil(wait), 1.0, most));
}

double Admission::seconds_of(const Place& place, Clock::time_point now) {
  return std::chrono::duration<double>(place.held + (place.parked ? Clock::duration(0) : now - place.since)).count();
}

void Admission::leave(Place& place) noexcept {
  const auto now = now_();
  Waiters calls;
  {
    const std::lock_guard lock(mutex_);
    const double took = seconds_of(place, now);
    Client& client = *place.client;
    if (place.counts) {
      if (metrics_) metrics_->ran(took);
      mean_ += forgetful * (took - mean_);
      const bool is_long = place.limit > std::chrono::duration<double>(patience).count();
      if (is_long && std::isfinite(place.limit)) kept_ += forgetful * (std::min(took / place.limit, 1.0) - kept_);
    }
    if (place.account) add(*place.account, took, now);
    if (place.beside) --besides_;
    place.number = 0;
    place.account = nullptr;
    if (place.parked) {
      --parked_, --client.parked;
      used_.erase(place.self);
    } else {
      --running_, --client.running;
      free_.splice(free_.end(), used_, place.self);
    }
    forget(client);
    admit_waiting(calls);
  }
  run(std::move(calls));
}

bool Admission::park(Ticket ticket) {
  std::list<Place> one(1);
  Waiters calls;
  {
    const std::lock_guard lock(mutex_);
    Place* const place = ticket.place;
    const auto same = [&](const Place& used) { return &used == place && used.number == ticket.number; };
    if (std::none_of(used_.begin(), used_.end(), same) || place->parked) return false;
    place->held += now_() - place->since;
    place->parked = true;
    free_.splice(free_.end(), one);
    --running_, --place->client->running;
    ++parked_, ++place->client->parked;
    admit_waiting(calls);
  }
  run(std::move(calls));
  return true;
}

bool Admission::resume(Ticket ticket, const std::function<bool()>& gone) {
  std::promise<void> come;
  auto came = come.get_future();
  const auto now = now_();
  Waiters calls, itself;
  itself.push_back({nullptr, -std::numeric_limits<double>::infinity(), now, Clock::time_point::max(), gone,
                    [&come](const std::optional<Pass>&) { come.set_value(); }, ticket.place});
  Turns its_turn{nullptr};
  bool closed = false;
  {
    const std::lock_guard lock(mutex_);
    closed = closed_;
    ++resuming_;
    line_up(*ticket.place->client, itself, its_turn);
    admit_waiting(calls);
  }
  run(std::move(calls));
  if (closed) look();
  came.wait();
  const std::lock_guard lock(mutex_);
  return !ticket.place->parked;
}

void Admission::readmit(Place& place) noexcept {
  free_.pop_front();
  place.parked = false;
  place.since = now_();
  --parked_, --place.client->parked;
  ++running_, ++place.client->running;
}

// admit_waiting gives free places to those who wait.
void Admission::admit_waiting(Waiters& calls) noexcept {
  while (running_ < places_ && !turns_.empty() && !closed_) {
    const auto turn = next();
    Client& client = **turn;
    auto chosen = client.waiting.begin();
    // Every other turn of an address goes to the request that has waited longest: otherwise a connection that computed
    // more than others, or was charged for other load of the machine, would wait until all others have computed as
    // much.
    if (client.longest_is_next && !chosen->resumes)
      chosen = std::min_element(client.waiting.begin(), client.waiting.end(),
                                [](const Waiter& a, const Waiter& b) { return a.from < b.from; });
    client.longest_is_next = !client.longest_is_next;
    calls.splice(calls.end(), client.waiting, chosen);
    if (client.waiting.empty()) {
      turns_.erase(turn);
    } else {
      turns_.splice(turns_.end(), turns_, turn);
    }
    --waiting_;
    Waiter& waiter = calls.back();
    if (waiter.resumes) {
      --resuming_;
      readmit(*waiter.resumes);
      continue;
    }
    if (metrics_) metrics_->waited(std::chrono::duration<double>(now_() - waiter.from).count());
    waiter.pass.emplace(admitted(client, waiter.account));
  }
}

// next() returns the client whose turn it is: the first that holds less than its share; if none does, the first.
Admission::Turns::iterator Admission::next() {
  const unsigned share = (places_ + 1) / 2;
  const auto entitled =
      std::find_if(turns_.begin(), turns_.end(), [&](const Client* client) { return client->running < share; });
  return entitled == turns_.end() ? turns_.begin() : entitled;
}

// make_room removes the last request of the client with most requests in the queue, if that is more than the newcomer
// would have; else the last one of the newcomer's own client, if its connection has computed more than the newcomer's.
bool Admission::make_room(const Client& newcomer, double rank, Waiters& calls) {
  const auto most = std::max_element(clients_.begin(), clients_.end(), [](const auto& a, const auto& b) {
    return a.second.waiting.size() < b.second.waiting.size();
  });
  Client* crowd = &most->second;
  if (crowd->waiting.size() <= newcomer.waiting.size() + 1) {
    if (newcomer.waiting.empty() || newcomer.waiting.back().rank <= rank) return false;
    crowd = &clients_.find(newcomer.name)->second;
  }
  const auto last = std::prev(crowd->waiting.end());
  if (last->resumes) return false;
  refuse(calls, crowd->waiting, last);
  --waiting_;
  if (crowd->waiting.empty()) turns_.remove(crowd);
  return true;
}

double Admission::clock(Clock::time_point now) const {
  return std::chrono::duration<double>(now - epoch_).count() / fading;
}

// A new account starts at the mean of those waiting: nobody gains by a new connection for each request, and a new
// client need not wait for all others.
void Admission::introduce(Account& account, const Client& client, Clock::time_point now) const {
  if (account.known_) return;
  account.known_ = true;
  double all = 0;
  std::size_t count = 0;
  for (const Waiter& waiter : client.waiting) {
    if (waiter.resumes) continue;
    all += std::exp(waiter.rank - clock(now));
    ++count;
  }
  if (count > 0) add(account, all / static_cast<double>(count), now);
}

void Admission::add(Account& account, double seconds, Clock::time_point now) const {
  account.rank_ = std::log(std::exp(account.rank_ - clock(now)) + seconds) + clock(now);
}

// told_left returns the remaining seconds of a run with a limit beyond `patience`, whose author must have known why:
// the usual fraction of such limits, less the time taken, once the run has gone on for a while without being parked;
// else 0.
double Admission::told_left(const Place& place, Clock::time_point now) const {
  const double taken = seconds_of(place, now);
  const bool is_long = std::isfinite(place.limit) && place.limit > std::chrono::duration<double>(patience).count() &&
                       taken > a_while && place.held == Clock::duration(0) && !place.beside;
  return is_long ? std::max(kept_ * place.limit - taken, 0.0) : 0;
}

// left_of returns the expected remaining seconds of a run: it ends at the mean duration, or after twice the time taken,
// or as told_left says, and at its limit at the latest.
double Admission::left_of(const Place& place, Clock::time_point now) const {
  if (place.beside) return 0;  // it is given back as soon as somebody waits
  const double taken = seconds_of(place, now);
  const double expected = std::max({mean_, 2 * taken, taken + told_left(place, now)});
  return std::max(std::min(expected, place.limit) - taken, 0.0);
}

// expected_wait returns the seconds for a client and a rank, assuming that as many requests of every other client are
// served before it as of its own.
double Admission::expected_wait(const Client* client, double rank, Clock::time_point now) const {
  if (places_ == 0) return 0;
  std::size_t own = 0, ahead = 1;  // the request itself
  if (client) {
    own = static_cast<std::size_t>(std::count_if(client->waiting.begin(), client->waiting.end(),
                                                 [&](const Waiter& waiter) { return waiter.rank <= rank; }));
  }
  for (const Client* other : turns_) ahead += other == client ? own : std::min(other->waiting.size(), own + 1);
  ends_.clear();
  for (const Place& place : used_)
    if (!place.parked) ends_.push_back(left_of(place, now));
  ends_.resize(places_, 0);  // free places
  std::make_heap(ends_.begin(), ends_.end(), std::greater<>());
  for (;;) {
    std::pop_heap(ends_.begin(), ends_.end(), std::greater<>());
    if (--ahead == 0) return ends_.back();
    ends_.back() += mean_;
    std::push_heap(ends_.begin(), ends_.end(), std::greater<>());
  }
}

void Admission::forget(const Client& client) {
  if (client.running == 0 && client.parked == 0 && client.waiting.empty()) clients_.erase(clients_.find(client.name));
}

}  // namespace least::server
