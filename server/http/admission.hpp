// Who computes, and who waits for it: a bounded number of runs at once and a bounded queue, in which clients take
// turns.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace least::server {

class Metrics;

/// Clients (addresses) are served round robin, the requests of one in the order in which they came. While others wait,
/// a client holds at most half of the places, rounded up. Where the queue is full, the client with most in it gives way
/// to one with less. Where memory is out, who asks is told so by an exception and nothing has changed; to give a turn
/// back, to admit and to refuse take none.
class Admission {
  struct Client;

 public:
  using Clock = std::chrono::steady_clock;

  /// `places` runs at once, `queue` more that wait. What happens is counted in `metrics`, where there are any.
  Admission(unsigned places, unsigned queue, Metrics* metrics = nullptr)
      : places_(places), queue_(queue), metrics_(metrics) {}

  /// The right to compute, given back at its end.
  class Pass {
   public:
    /// `counts`: as a run, among those whose times are told; else a place that a run has besides its own.
    Pass(Admission& admission, Client& client, bool counts) noexcept
        : admission_(&admission), client_(&client), counts_(counts), beside_(!counts) {}
    Pass(Pass&& other) noexcept
        : admission_(std::exchange(other.admission_, nullptr)),
          client_(other.client_),
          counts_(other.counts_),
          beside_(other.beside_),
          start_(other.start_) {}
    Pass& operator=(Pass&&) = delete;
    ~Pass() {
      if (!admission_) return;
      admission_->leave(*client_, counts_ ? std::optional(Clock::now() - start_) : std::nullopt, beside_);
    }

    /// No run came of it.
    void excuse() { counts_ = false; }

   private:
    Admission* admission_;
    Client* client_;
    bool counts_, beside_;
    Clock::time_point start_ = Clock::now();
  };

  /// A turn that is free now.
  std::optional<Pass> enter(std::string_view name);

  /// What is done when the turn comes, or with nothing when it does not. It is called once, by whoever gives a place
  /// back, ends the wait or asks: it hands its work on, and may not throw.
  using Turn = std::function<void(std::optional<Pass>)>;

  /// Waits for a turn, without a thread. There is none, and that at once: the queue is full, or the turn is not to be
  /// expected within `patience`; or later: the patience is over, the client `gone` (may be empty), its place in the
  /// queue needed by another, or the service ends.
  void wait(std::string_view name, std::chrono::milliseconds patience, std::function<bool()> gone, Turn turn);

  /// Ends the waits that are over. To be called now and then.
  void look();

  /// A further place for a run that has one, as long as nobody waits and its client holds less than its share: half of
  /// them, or all while no other client computes.
  std::optional<Pass> enter_besides(std::string_view name);
  /// Whether a client that holds places besides is to give them back: somebody waits, or it holds more than its share.
  bool gives_way(std::string_view name) const;
  unsigned places() const { return places_; }

  /// Nobody enters any more; those who wait leave with nothing.
  void close();

  struct Load {
    unsigned running = 0, waiting = 0;
    bool full = false;  ///< the next one would be turned away
  };
  Load load() const;

  /// After how many whole seconds it is worth to ask again, at least 1.
  int retry_after() const;

 private:
  struct Waiter {
    Clock::time_point from, until;
    std::function<bool()> gone;
    Turn turn;
    std::optional<Pass> pass{};  ///< once it came
  };
  // Moved from one list to another, which takes no memory.
  using Waiters = std::list<Waiter>;
  using Turns = std::list<Client*>;
  struct Client {
    std::string_view name{};
    unsigned running = 0;
    Waiters waiting{};
  };

  Client& client_of(std::string_view name);
  std::optional<Pass> admitted(Client& client, bool counts = true) noexcept;
  void leave(Client& client, std::optional<Clock::duration> took, bool beside) noexcept;
  // `calls`: those whose turn came or never will, called when the lock is free.
  static void run(Waiters calls) noexcept;
  void refuse(Waiters& calls, Waiters& from, Waiters::iterator waiter) noexcept;
  void admit_waiting(Waiters& calls) noexcept;
  Turns::iterator next();
  bool make_room(const Client& newcomer, Waiters& calls);
  double expected_wait(std::size_t own) const;
  unsigned share_of(const Client& client) const;
  void forget(const Client& client);

  mutable std::mutex mutex_;
  const unsigned places_, queue_;
  Metrics* const metrics_;
  unsigned running_ = 0, waiting_ = 0;
  unsigned besides_ = 0;                                // of those who run: they give way to whoever waits
  std::map<std::string, Client, std::less<>> clients_;  // those who compute or wait
  Turns turns_;                                         // those who wait, the next one first
  double mean_ = 0;                                     // seconds of a run, the latest counting most
  bool closed_ = false;
};

}  // namespace least::server
