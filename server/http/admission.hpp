// Who computes, and who waits for it: a bounded number of runs at once and a bounded queue, in which clients take
// turns.
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

/// Who asks: a connection, of an address. What it computed lately counts.
class Account {
 public:
  explicit Account(std::string address) : address_(std::move(address)) {}
  const std::string& address() const { return address_; }

 private:
  friend class Admission;

  const std::string address_;
  // The logarithm of the seconds that it computed, each fading as time goes by, plus that time in units of the fading:
  // the same at all times, so that accounts are compared as they stand.
  double rank_ = -std::numeric_limits<double>::infinity();
  bool known_ = false;  // has asked before
};
using AccountPtr = std::shared_ptr<Account>;

/// Addresses are served round robin; of one address by turns the connection that computed least of late, a new one
/// counting as the mean of those that wait, and the request that has waited longest. While others wait, an address
/// holds at most half of the places, rounded up. Where the queue is full, the address with most in it gives way to one
/// with less, and within an address who computed more. Where memory is out, who asks is told so by an exception and
/// nothing has changed; to give a turn back, to admit and to refuse take none.
class Admission {
  struct Client;
  struct Place;

 public:
  using Clock = std::chrono::steady_clock;

  /// So long a request waits for its turn: longer than most runs take, shorter than what clients and proxies wait for.
  static constexpr std::chrono::seconds patience{10};

  /// `places` runs at once, `queue` more that wait. What happens is counted in `metrics`, where there are any. `now`
  /// tells the time, and may not throw.
  Admission(unsigned places, unsigned queue, Metrics* metrics = nullptr,
            std::function<Clock::time_point()> now = Clock::now);

  /// Names a run that has a place.
  struct Ticket {
    Place* place = nullptr;
    std::uint64_t number = 0;
  };

  /// The right to compute, given back at its end.
  class Pass {
   public:
    Pass(Admission& admission, Place& place) noexcept : admission_(&admission), place_(&place) {}
    Pass(Pass&& other) noexcept : admission_(std::exchange(other.admission_, nullptr)), place_(other.place_) {}
    Pass& operator=(Pass&&) = delete;
    ~Pass() {
      if (admission_) admission_->leave(*place_);
    }

    /// No run came of it.
    void excuse();
    /// The run ends after so many seconds at the latest.
    void may_take(double seconds);
    /// Whether others have the place meanwhile.
    bool parked() const;
    Ticket ticket() const;

   private:
    Admission* admission_;
    Place* place_;
  };

  /// A turn that is free now.
  std::optional<Pass> enter(const AccountPtr& account);
  std::optional<Pass> enter(std::string_view address) { return enter(std::make_shared<Account>(std::string(address))); }

  /// What is done when the turn comes, or with nothing when it does not. It is called once, by whoever gives a place
  /// back, ends the wait or asks: it hands its work on, and may not throw.
  using Turn = std::function<void(std::optional<Pass>)>;

  /// Waits for a turn, without a thread. There is none, and that at once: the queue is full, or the turn is not to be
  /// expected within `most`; or later: that time is over, the client `gone` (may be empty), its place in the
  /// queue needed by another, or the service ends.
  void wait(const AccountPtr& account, std::chrono::milliseconds most, std::function<bool()> gone, Turn turn);

  /// Counts so many seconds as computed by an account, now.
  void charge(Account& account, double seconds) const;

  /// Ends the waits that are over. To be called now and then.
  void look();

  /// Gives the place of a run that waits for its client to others; false: it has none. May throw, then nothing changed.
  bool park(Ticket ticket);
  /// Waits for a place again, on this thread, before those of its address who have not begun. False: the client is
  /// gone, or the service ends.
  bool resume(Ticket ticket, const std::function<bool()>& gone);

  /// A further place for a run that has one, as long as nobody waits and its client holds less than its share: half of
  /// them, or all while no other client computes.
  std::optional<Pass> enter_besides(std::string_view address);
  /// Whether a client that holds places besides is to give them back: somebody waits, or it holds more than its share.
  bool gives_way(std::string_view address) const;
  unsigned places() const { return places_; }
  unsigned queue() const { return queue_; }

  /// Nobody enters any more; those who wait leave with nothing.
  void close();

  struct Load {
    unsigned running = 0, waiting = 0, parked = 0;
    bool full = false;  ///< the next one would be turned away
  };
  Load load() const;

  /// After how many whole seconds it is worth to ask again, at least 1: when a place is expected.
  int retry_after(const AccountPtr& account = nullptr) const;

 private:
  // Of a run; those that are free are kept, so that to admit takes no memory.
  struct Place {
    Client* client = nullptr;
    AccountPtr account{};
    std::uint64_t number = 0;
    bool counts = true;   // as a run, among those whose times are told
    bool beside = false;  // a place that a run has besides its own
    bool parked = false;
    Clock::time_point since{};
    Clock::duration held{0};  // before that
    double limit = std::numeric_limits<double>::infinity();
    std::list<Place>::iterator self{};
  };
  struct Waiter {
    AccountPtr account;
    double rank;
    Clock::time_point from, until;
    std::function<bool()> gone;
    Turn turn;
    Place* resumes = nullptr;    // a run that was parked
    std::optional<Pass> pass{};  // once it came
  };
  // Moved from one list to another, which takes no memory.
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
  // `calls`: those whose turn came or never will, called when the lock is free.
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
  unsigned resuming_ = 0;                               // of those who wait: they have begun
  unsigned besides_ = 0;                                // of those who run: they give way to whoever waits
  std::list<Place> used_, free_;                        // free_: as many as there are free places
  std::uint64_t last_ = 0;                              // number of a run
  std::map<std::string, Client, std::less<>> clients_;  // those who compute or wait
  Turns turns_;                                         // those who wait, the next one first
  double mean_ = 0;                                     // seconds of a run, the latest counting most
  double kept_ = 1;  // of the limits beyond `patience` that runs had, the part that they took, likewise
  mutable std::vector<double> ends_;  // for `expected_wait`, which may not take memory
  bool closed_ = false;
};

}  // namespace least::server
