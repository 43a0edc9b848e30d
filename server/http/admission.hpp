// Admission control: a bounded number of runs at once, and a bounded queue in which clients take turns.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace least::server {

class Metrics;

/// Account is the client of a connection, with its address and a measure of its recent computing time.
class Account {
 public:
  explicit Account(std::string address) : address_(std::move(address)) {}
  const std::string& address() const { return address_; }

 private:
  friend class Admission;

  const std::string address_;
  // The logarithm of the seconds that it computed, each weighted by e^(−age/fading), plus now/fading. This sum does not
  // change while nothing is computed, so that accounts can be compared at any time.
  double rank_ = -std::numeric_limits<double>::infinity();
  bool known_ = false;  // has asked before
};
using AccountPtr = std::shared_ptr<Account>;

/// Admission. Addresses are served round robin; within an address, alternately the connection that has computed the
/// shortest time of late (a new one counts as the mean of those waiting) and the request that has waited longest. While
/// others wait, an address holds at most half of the places, rounded up. When the queue is full, the address with most
/// requests in it loses one to an address with fewer, and within an address the connection that computed more loses.
/// When memory is short, entering throws and changes nothing; giving back a place, admitting and refusing need no
/// memory.
class Admission {
  struct Client;
  struct Place;

 public:
  using Clock = std::chrono::steady_clock;

  /// How long a request waits for its turn at most: longer than most runs take, shorter than clients and proxies wait.
  static constexpr std::chrono::seconds patience{10};

  /// `places` runs at once, and `queue` more waiting. Events are counted in `metrics`, if given. `now` returns the time
  /// and must not throw.
  Admission(unsigned places, unsigned queue, Metrics* metrics = nullptr,
            std::function<Clock::time_point()> now = Clock::now);

  /// Ticket identifies a run that has a place.
  struct Ticket {
    Place* place = nullptr;
    std::uint64_t number = 0;
  };

  /// Pass is the right to compute; its destructor gives the place back.
  class Pass {
   public:
    Pass(Admission& admission, Place& place) noexcept : admission_(&admission), place_(&place) {}
    Pass(Pass&& other) noexcept : admission_(std::exchange(other.admission_, nullptr)), place_(other.place_) {}
    Pass& operator=(Pass&&) = delete;
    ~Pass() {
      if (admission_) admission_->leave(*place_);
    }

    /// excuse(): no run came of it, so that its time does not count as one.
    void excuse();
    /// may_take(seconds): the run ends within that time.
    void may_take(double seconds);
    /// parked() tells whether others use the place at present.
    bool parked() const;
    Ticket ticket() const;

   private:
    Admission* admission_;
    Place* place_;
  };

  /// enter returns a place that is free now, or nothing.
  std::optional<Pass> enter(const AccountPtr& account);
  std::optional<Pass> enter(std::string_view address) { return enter(std::make_shared<Account>(std::string(address))); }

  /// Turn is called once, with the pass when the turn comes, or with nothing when it never will. The caller is whoever
  /// gives a place back, ends the wait or asks; hence a Turn must hand its work on, and must not throw.
  using Turn = std::function<void(std::optional<Pass>)>;

  /// wait queues for a turn, without a thread. The wait fails at once if the queue is full or the turn is not expected
  /// within `most`; it fails later if that time is over, the client is `gone` (may be empty), its place in the queue is
  /// needed by another, or the service ends.
  void wait(const AccountPtr& account, std::chrono::milliseconds most, std::function<bool()> gone, Turn turn);

  /// look() ends the waits that are over; to be called regularly.
  void look();

  /// park gives the place of a run that waits for its client to others; false: it has none. May throw, and then nothing
  /// has changed.
  bool park(Ticket ticket);
  /// resume waits on this thread until the run has a place again; it comes before those of its address who have not
  /// begun. False: the client is gone, or the service ends.
  bool resume(Ticket ticket, const std::function<bool()>& gone);

  /// enter_besides returns a further place for a client that has one, while nobody waits and the client holds less than
  /// its share: half of the places, or all while no other client computes.
  std::optional<Pass> enter_besides(std::string_view address);
  /// gives_way tells whether a client has to give such further places back: somebody waits, or it holds more than its
  /// share.
  bool gives_way(std::string_view address) const;
  unsigned places() const { return places_; }
  unsigned queue() const { return queue_; }

  /// close(): nobody enters any more; those who wait are called with nothing.
  void close();

  struct Load {
    unsigned running = 0, waiting = 0, parked = 0;
    bool full = false;  ///< the next request would be refused
  };
  Load load() const;

  /// retry_after returns the number of whole seconds until a place is expected, at least 1.
  int retry_after(const AccountPtr& account = nullptr) const;

 private:
  // The place of a run. Free places are kept in a list, so that admitting takes no memory.
  struct Place {
    Client* client = nullptr;
    AccountPtr account{};
    std::uint64_t number = 0;
    bool counts = true;   // counts as a run in the mean duration
    bool beside = false;  // a further place of a client that has one, from enter_besides
    bool parked = false;
    Clock::time_point since{};
    Clock::duration held{0};  // time held before it was parked
    double limit = std::numeric_limits<double>::infinity();
    std::list<Place>::iterator self{};
  };
  struct Waiter {
    AccountPtr account;
    double rank;
    Clock::time_point from, until;
    std::function<bool()> gone;
    Turn turn;
    Place* resumes = nullptr;    // a parked run that waits to go on; null for a new request
    std::optional<Pass> pass{};  // set once the turn came
  };
  // Entries are spliced from one list to another, which takes no memory.
  using Waiters = std::list<Waiter>;
  using Turns = std::list<Client*>;
  struct Client {
    std::string_view name{};
    unsigned running = 0, parked = 0;
    Waiters waiting{};             // the next one first
    bool longest_is_next = false;  ///< the next turn is that of the request that has waited longest
  };

  Client& client_of(std::string_view address);
  Pass admitted(Client& client, AccountPtr account, bool beside = false) noexcept;
  void readmit(Place& place) noexcept;
  void leave(Place& place) noexcept;
  static double seconds_of(const Place& place, Clock::time_point now);
  // Runs the callbacks of those whose turn came or never will; called without the lock.
  static void run(Waiters calls) noexcept;
  void refuse(Waiters& calls, Waiters& from, Waiters::iterator waiter) noexcept;
  void line_up(Client& client, Waiters& newcomer, Turns& its_turn) noexcept;
  void admit_waiting(Waiters& calls) noexcept;
  Turns::iterator next();
  bool make_room(const Client& newcomer, double rank, Waiters& calls);
  double clock(Clock::time_point now) const;
  void introduce(Account& account, const Client& client, Clock::time_point now) const;
  void add(Account& account, double seconds, Clock::time_point now) const;
  double told_left(const Place& place, Clock::time_point now) const;
  double left_of(const Place& place, Clock::time_point now) const;
  double expected_wait(const Client* client, double rank, Clock::time_point now) const;
  unsigned queued() const { return waiting_ - resuming_; }
  unsigned share_of(const Client& client) const;
  void forget(const Client& client);

  mutable std::mutex mutex_;
  const unsigned places_, queue_;
  Metrics* const metrics_;
  const std::function<Clock::time_point()> now_;
  const Clock::time_point epoch_ = now_();
  unsigned running_ = 0, waiting_ = 0, parked_ = 0;
  unsigned resuming_ = 0;         // waiting runs that have begun, and were parked
  unsigned besides_ = 0;          // running places from enter_besides, which give way to whoever waits
  std::list<Place> used_, free_;  // free_: as many as there are free places
  std::uint64_t last_ = 0;        // the last ticket number
  std::map<std::string, Client, std::less<>> clients_;  // clients that compute or wait
  Turns turns_;                                         // clients that wait, the next one first
  double mean_ = 0;                                     // mean seconds of a run, weighted to the latest
  double kept_ = 1;                   // mean fraction that runs used of a limit beyond `patience`, likewise
  mutable std::vector<double> ends_;  // scratch for expected_wait, which must not allocate
  bool closed_ = false;
};

}  // namespace least::server
