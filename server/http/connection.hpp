// One client connection, moved on by the event loop: whole requests come off it, answers go onto it, and nothing ever
// waits. Everything a client can stretch has a bound here: sizes, counts, times.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/http/exchange.hpp"
#include "server/http/request_reader.hpp"
#include "server/shared/memory_budget.hpp"

namespace least::server {

/// What all connections look at.
struct Lifecycle {
  std::atomic<bool> leaving{false};    ///< the service is not ready any more, though it serves as ever
  std::atomic<bool> draining{false};   ///< no new requests; those that came are answered
  std::atomic<bool> cancelled{false};  ///< runs end now
  std::atomic<bool> crowded{false};    ///< clients wait to be let in
  MemoryBudget* memory = nullptr;      ///< for what they send; none: no bound
};

/// Bounds of one connection. A client that is slower than this is let go.
struct ConnectionBounds : RequestBounds {
  std::chrono::milliseconds idle{60'000};  ///< between requests
  std::chrono::milliseconds head_time{5'000}, body_time{10'000};
  std::chrono::milliseconds stall{5'000};  ///< without one byte taken by the client while answering
  /// An answer waits for its client no longer than this, and no longer than bytes leave at `rate` in a second.
  std::chrono::milliseconds drip{5'000};
  double rate = 64 * 1024;
  /// What the system holds for a client counts as taken: no more than a few seconds of the slowest that is borne.
  int send_buffer = 256 * 1024;
};

/// Whose connection it is.
struct Peer {
  std::string address;
  bool for_metrics = false;  ///< it came by the port for them
  AccountPtr account;        ///< who asks: another address where a proxy says so
};

/// What becomes of requests. Called by the loop, which it may not hold up.
class Handler {
 public:
  virtual ~Handler() = default;
  /// A request came; its answer goes into the `line`, from any thread.
  virtual ExchangePtr begin(Message message, Peer& peer, Line line) = 0;
  /// The same for what cannot be one; its connection ends with the answer.
  virtual ExchangePtr refuse(Refused refused, const Peer& peer, Line line) = 0;
  /// There is room for more pieces of an answer.
  virtual void go_on(const ExchangePtr& exchange) = 0;
  /// A client went away within a request.
  virtual void aborted(const std::string& address) noexcept = 0;
  /// A client went away before its answer was whole.
  virtual void left(const Exchange& exchange) noexcept = 0;
  /// Whether there are requests left, of clients who may be gone.
  virtual bool busy() const = 0;
};

class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// Owns the socket, which does not block. `came` asks for a further `advance`, from any thread.
  Connection(int socket, Peer peer, const ConnectionBounds& bounds, const Lifecycle& lifecycle, Handler& handler,
             std::function<void()> came);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// What the system says of the socket: EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLERR, EPOLLHUP, each when it changed.
  void note(unsigned events);
  /// Does what can be done now.
  void advance();
  /// Looks at the clocks.
  void tick(Clock::time_point now);

  bool closed() const { return state_ == State::closed; }
  /// Who makes room for others, the smallest first: those who ask nothing, then those whose request does not come, by
  /// the time since when. Nothing: there is a request, or one may be on its way.
  std::optional<std::pair<bool, Clock::time_point>> makes_room(Clock::time_point now) const;

 private:
  enum class State { reading, answering, lingering, closed };

  bool step();
  bool read_request();
  bool send_answer();
  bool finish(bool whole);
  bool discard();
  bool receive();
  void begin(ExchangePtr exchange);
  void probe(Clock::time_point now);
  bool too_slow(Clock::time_point now);
  void unblock(Clock::time_point now);
  void leave();
  void cut_off();

  const int socket_;
  Peer peer_;
  const ConnectionBounds& bounds_;
  const Lifecycle& lifecycle_;
  Handler& handler_;
  const std::function<void()> came_;

  State state_ = State::reading;
  RequestReader reader_;
  RequestReader::Awaits awaited_ = RequestReader::Awaits::request;
  Clock::time_point since_ = Clock::now(), last_byte_ = since_;  // of this state; and received
  bool readable_ = true, writable_ = true;                       // as far as is known: to be tried
  bool half_closed_ = false;                                     // the client sends no more
  bool drained_ = false;                                         // and all it sent was read
  bool fresh_ = true;                                            // no request came yet

  ExchangePtr exchange_;
  std::string sending_;  // of its answer; sent up to `offset_`
  std::size_t offset_ = 0, taken_ = 0;
  Outbox::State more_ = Outbox::State::open;
  Clock::time_point blocked_from_;
  Clock::duration blocked_{0}, stalled_{0};  // that its client let it wait, and since it took the last byte
  Clock::time_point last_write_ = Clock::time_point::max();  // set when the service ends: so long may all be sent
  Clock::time_point next_probe_;
  Clock::duration between_probes_{};
};

}  // namespace least::server
