#include "server/http/connection.hpp"

#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>
#include <variant>

namespace least::server {
namespace {

using namespace std::chrono_literals;
using Awaits = RequestReader::Awaits;

constexpr auto on_its_way = 250ms;  // time for a client to send a request that it has begun, or is about to begin
constexpr auto last_word = 1s;      // when the service ends: time for the rest of a request, or for a client to hang up
constexpr auto farewell = 300ms;    // once runs are cancelled: time for the rest of answers
constexpr auto first_probe = 50ms;
constexpr std::string_view every_answer = "HTTP/1.1 ";  // the first bytes of every answer, also to HTTP/1.0
constexpr std::string_view go_ahead = "HTTP/1.1 100 Continue\r\n\r\n";

}  // namespace

Connection::Connection(int socket, Peer peer, const ConnectionBounds& bounds, const Lifecycle& lifecycle,
                       Handler& handler, std::function<void()> came)
    : socket_(socket),
      peer_(std::move(peer)),
      bounds_(bounds),
      lifecycle_(lifecycle),
      handler_(handler),
      came_(std::move(came)),
      reader_(bounds, lifecycle.memory) {}

Connection::~Connection() {
  if (!closed()) leave();
  ::close(socket_);
}

void Connection::note(unsigned events) {
  if (events & (EPOLLERR | EPOLLHUP)) return leave();
  if (events & EPOLLRDHUP) half_closed_ = true;
  if (events & (EPOLLIN | EPOLLRDHUP)) readable_ = true;
  if ((events & EPOLLOUT) && !writable_) unblock(Clock::now());
}

void Connection::unblock(Clock::time_point now) {
  writable_ = true;
  blocked_ += now - blocked_from_;
  stalled_ += now - blocked_from_;
}

// The number of steps is limited, so that one busy connection lets others have a turn.
void Connection::advance() {
  constexpr int most = 16;
  for (int i = 0; i < most; ++i) {
    if (!step()) return;
  }
  came_();
}

// step() returns false when nothing can be done until something happens.
bool Connection::step() {
  switch (state_) {
    case State::reading:
      return read_request();
    case State::answering:
      return send_answer();
    case State::lingering:
      return discard();
    case State::closed:
      break;
  }
  return false;
}

bool Connection::read_request() {
  Received received = reader_.read();
  if (auto* const message = std::get_if<Message>(&received)) {
    begin(handler_.begin(std::move(*message), peer_, {socket_, came_}));
    return true;
  }
  if (auto* const refused = std::get_if<Refused>(&received)) {
    begin(handler_.refuse(std::move(*refused), peer_, {socket_, came_}));
    return true;
  }
  if (reader_.asks_to_continue()) (void)!::send(socket_, go_ahead.data(), go_ahead.size(), MSG_NOSIGNAL);
  if (const Awaits awaits = reader_.awaits(); awaits != awaited_) {
    awaited_ = awaits;
    since_ = Clock::now();
  }
  if (drained_) leave();
  return receive();
}

// receive() reads what there is; false where there is nothing.
bool Connection::receive() {
  if (!readable_ || drained_ || state_ == State::closed) return false;
  char bytes[16 * 1024];
  const auto n = ::recv(socket_, bytes, sizeof bytes, 0);
  if (n > 0) {
    if (state_ == State::reading) reader_.buffer().append(bytes, static_cast<std::size_t>(n));
    last_byte_ = Clock::now();
    readable_ = half_closed_ || n == sizeof bytes;  // otherwise the system reports further bytes
    return true;
  }
  if (n == 0) return drained_ = half_closed_ = true;
  if (errno == EINTR) return true;
  readable_ = false;
  if (errno != EAGAIN && errno != EWOULDBLOCK) leave();
  return false;
}

void Connection::begin(ExchangePtr exchange) {
  exchange_ = std::move(exchange);
  state_ = State::answering;
  since_ = Clock::now();
  fresh_ = false;
  next_probe_ = since_ + first_probe;
  between_probes_ = first_probe;
  taken_ = 0;
  blocked_ = stalled_ = {};
}

bool Connection::send_answer() {
  if (offset_ == sending_.size()) {
    offset_ = 0;
    more_ = exchange_->outbox.take(sending_, readable_ || !reader_.buffer().empty());
    if (more_ == Outbox::State::open && exchange_->has_pieces) handler_.go_on(exchange_);
    if (sending_.empty()) return more_ != Outbox::State::open && finish(more_ == Outbox::State::whole);
  }
  if (!writable_) return false;
  const auto n = ::send(socket_, sending_.data() + offset_, sending_.size() - offset_, MSG_NOSIGNAL);
  if (n > 0) {
    offset_ += static_cast<std::size_t>(n);
    taken_ += static_cast<std::size_t>(n);
    stalled_ = {};
    if (offset_ == sending_.size() && more_ != Outbox::State::open) return finish(more_ == Outbox::State::whole);
    return true;
  }
  if (errno == EINTR) return true;
  if (errno == EAGAIN || errno == EWOULDBLOCK) {
    writable_ = false;
    blocked_from_ = Clock::now();
  } else {
    leave();
  }
  return false;
}

bool Connection::finish(bool whole) {
  const bool goes_on = whole && exchange_->keep_alive;
  exchange_->sent = whole;
  if (taken_ > 0) exchange_->over = Clock::now();
  if (!whole && exchange_->bare) cut_off();
  exchange_->end();
  exchange_.reset();
  sending_.clear();
  if (sending_.capacity() > 64 * 1024) sending_.shrink_to_fit();
  offset_ = 0;
  since_ = Clock::now();
  awaited_ = Awaits::request;
  if (goes_on) {
    state_ = State::reading;
  } else if (whole) {
    // Closing at once could destroy the answer before a client that is still sending has read it.
    ::shutdown(socket_, SHUT_WR);
    state_ = State::lingering;
  } else {
    state_ = State::closed;  // without a mark of an end
  }
  return state_ != State::closed;
}

bool Connection::discard() {
  if (!drained_) return receive();
  state_ = State::closed;
  return false;
}

// An orderly close would mark the end of the body: the connection is reset instead.
void Connection::cut_off() {
  const linger reset{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
}

// leave() is called when the client is gone, or disconnected by us.
void Connection::leave() {
  if (state_ == State::reading && reader_.awaits() != Awaits::request) handler_.aborted(peer_.address);
  state_ = State::closed;
  if (const auto exchange = std::exchange(exchange_, nullptr)) {
    // A client may leave at once after a complete answer
    exchange->sent = offset_ == sending_.size() && exchange->outbox.done();
    if (exchange->sent) return;
    handler_.left(*exchange);  // before the computing thread is woken, and ends
    exchange->left = true;
    exchange->outbox.close();
    if (taken_ > 0 && exchange->bare) cut_off();
  }
}

// A client that has only closed its sending side is still there, and one that hung up looks the same: only sending
// shows the difference, as the latter answers with a reset. So probe() sends, now and then, a byte that has to be sent
// anyway: of the line that begins every answer; within an answer, a zero before the size of the next chunk (RFC 9112,
// 7.1), or the beginning of the next piece.
void Connection::probe(Clock::time_point now) {
  if (!half_closed_ || now < next_probe_ || offset_ < sending_.size() || !writable_) return;
  next_probe_ = now + (between_probes_ *= 2);
  if (taken_ > 0 && exchange_->chunked) return exchange_->outbox.interject("0");
  exchange_->outbox.send_ahead(taken_ == 0 ? every_answer : exchange_->begins);
}

bool Connection::too_slow(Clock::time_point now) {
  if (sending_.empty()) return false;
  if (lifecycle_.cancelled) {
    last_write_ = std::min(last_write_, now + farewell);
    if (now > last_write_) return true;
  }
  const std::chrono::duration<double> waited = blocked_;
  return stalled_ > bounds_.stall ||
         (waited > bounds_.drip && static_cast<double>(taken_) < bounds_.rate * waited.count());
}

void Connection::tick(Clock::time_point now) {
  const auto waited = now - since_;
  if (state_ == State::lingering) {
    if (waited > last_word || lifecycle_.cancelled) state_ = State::closed;
  } else if (state_ == State::answering) {
    // The system reports room only when there is much of it; a slow reader makes little at a time.
    if (!writable_) unblock(now);
    if (too_slow(now)) return leave();
    advance();
    if (state_ == State::answering) probe(now);
  } else if (state_ == State::reading && awaited_ == Awaits::request) {
    const bool ends = lifecycle_.draining && (!fresh_ || waited > on_its_way);
    if (waited > bounds_.idle || ends || lifecycle_.cancelled) leave();
  } else if (state_ == State::reading) {
    // A client that sends nothing more must not delay the end.
    if (lifecycle_.cancelled || (lifecycle_.draining && now - last_byte_ > last_word)) return leave();
    if (waited <= (awaited_ == Awaits::head ? bounds_.head_time : bounds_.body_time)) return;
    begin(handler_.refuse(reader_.too_late(), peer_, {socket_, came_}));
    advance();
  }
}

std::optional<std::pair<bool, Connection::Clock::time_point>> Connection::makes_room(Clock::time_point now) const {
  const bool half = awaited_ != Awaits::request;
  const bool may_come = (fresh_ || half) && now - since_ < on_its_way;
  if (state_ != State::reading || readable_ || may_come) return std::nullopt;
  return std::pair(half, since_);
}

}  // namespace least::server
