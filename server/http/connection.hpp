// One client connection, driven by the event loop: it reads whole requests and sends answers, and never blocks.
// Everything a client can stretch is limited here: sizes, counts, times.
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

/// Lifecycle is the state of the service that all connections observe.
struct Lifecycle {
  std::atomic<bool> leaving{false};    ///< the service is not ready any more, although it still serves
  std::atomic<bool> draining{false};   ///< no new requests; those received are answered
  std::atomic<bool> cancelled{false};  ///< runs are to end now
  std::atomic<bool> crowded{false};    ///< clients wait to be accepted
  MemoryBudget* memory = nullptr;      ///< for what clients send; null: unlimited
};

/// ConnectionBounds are the limits of one connection. A client that is slower is disconnected.
struct ConnectionBounds : RequestBounds {
  std::chrono::milliseconds idle{60'000};  ///< between requests
  std::chrono::milliseconds head_time{5'000}, body_time{10'000};
  std::chrono::milliseconds stall{5'000};  ///< while answering, the longest time without the client taking a byte
  /// An answer waits for its client this long at most, unless the client takes at least `rate` bytes per second.
  std::chrono::milliseconds drip{5'000};
  double rate = 64 * 1024;
  /// Data in the system's buffer counts as taken; hence it may hold only a few seconds' worth for the slowest tolerated
  /// client.
  int send_buffer = 256 * 1024;
};

/// Peer is the client of a connection.
struct Peer {
  std::string address;
  bool for_metrics = false;  ///< connected to the port for metrics
  AccountPtr account;        ///< the account; under another address where a trusted proxy says so
};

/// Handler answers requests. The loop calls it, so that it must not block.
class Handler {
 public:
  virtual ~Handler() = default;
  /// begin: a request was received; its answer goes to `line`, from any thread.
  virtual ExchangePtr begin(Message message, Peer& peer, Line line) = 0;
  /// refuse does the same for an invalid request; the connection ends with the answer.
  virtual ExchangePtr refuse(Refused refused, const Peer& peer, Line line) = 0;
  /// go_on: there is room for more pieces of an answer.
  virtual void go_on(const ExchangePtr& exchange) = 0;
  /// aborted: a client disconnected within a request.
  virtual void aborted(const std::string& address) noexcept = 0;
  /// left: a client disconnected before its answer was complete.
  virtual void left(const Exchange& exchange) noexcept = 0;
  /// busy() tells whether requests are still being answered, perhaps of clients that are gone.
  virtual bool busy() const = 0;
};

/// Connection owns one non-blocking socket.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// `came` requests a further `advance`, and may be called from any thread.
  Connection(int socket, Peer peer, const ConnectionBounds& bounds, const Lifecycle& lifecycle, Handler& handler,
             std::function<void()> came);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// note takes edge-triggered events of the socket: EPOLLIN, EPOLLOUT, EPOLLRDHUP, EPOLLERR, EPOLLHUP.
  void note(unsigned events);
  /// advance() does all that can be done now.
  void advance();
  /// tick checks the time limits.
  void tick(Clock::time_point now);

  bool closed() const { return state_ == State::closed; }
  /// makes_room ranks connections that may be closed for others, the smallest first: those without a request, then
  /// those whose request does not arrive, by the time since when. Nothing: it has a request, or one may be arriving.
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
  // since_: of this state; last_byte_: of the last byte received
  Clock::time_point since_ = Clock::now(), last_byte_ = since_;
  bool readable_ = true, writable_ = true;  // as far as is known; to be tried
  bool half_closed_ = false;                // the client sends no more
  bool drained_ = false;                    // and all that it sent has been read
  bool fresh_ = true;                       // no request has been received yet

  ExchangePtr exchange_;
  std::string sending_;  // bytes of the answer, of which `offset_` are sent
  std::size_t offset_ = 0, taken_ = 0;
  Outbox::State more_ = Outbox::State::open;
  Clock::time_point blocked_from_;
  // blocked_: how long its client has let it wait in all; stalled_: since the last byte was taken
  Clock::duration blocked_{0}, stalled_{0};
  Clock::time_point last_write_ = Clock::time_point::max();  // set when runs are cancelled: the latest time of writing
  Clock::time_point next_probe_;
  Clock::duration between_probes_{};
};

}  // namespace least::server
