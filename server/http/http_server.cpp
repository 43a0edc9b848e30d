#include "server/http/http_server.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <new>
#include <random>
#include <system_error>
#include <thread>
#include <utility>

#include "server/http/answer_bytes.hpp"
#include "server/http/answer_writer.hpp"
#include "server/http/cancellation.hpp"
#include "server/http/event_loop.hpp"
#include "server/http/forwarded.hpp"
#include "server/http/http_date.hpp"
#include "server/http/memory_watch.hpp"
#include "server/http/workers.hpp"
#include "server/shared/log.hpp"

namespace least::server {
namespace {

using Clock = std::chrono::steady_clock;

Access access_of(const HttpSettings& settings) {
  Access access{settings.allow_hosts, settings.allow_origins, settings.allow_frames};
  access.hosts.insert(access.hosts.end(), {"localhost", "127.0.0.1", "[::1]", settings.host});
  if (settings.host.find(':') != std::string::npos) access.hosts.push_back('[' + settings.host + ']');
  return access;
}

}  // namespace

class HttpServer::Impl final : private Handler {
 public:
  Impl(HttpSettings settings, ErrorAnswer error, MemoryBudget* memory)
      : settings_(std::move(settings)),
        error_(error),
        admission_(places(), settings_.queue, &metrics_),
        router_(access_of(settings_), error),
        loop_(settings_.connections, settings_.bounds, lifecycle_, *this) {
    lifecycle_.memory = memory;
  }

  Router& router() { return router_; }
  Admission& admission() { return admission_; }
  Metrics& metrics() { return metrics_; }
  bool leaving() const { return lifecycle_.leaving; }
  std::size_t connections() const { return loop_.connections(); }
  int metrics_port() const { return loop_.metrics_port(); }
  const HttpSettings& settings() const { return settings_; }
  const std::atomic<bool>& cancelled() const { return lifecycle_.cancelled; }

  std::optional<std::string> start() try {
    for (const bool for_metrics : {false, true}) {
      const int port = for_metrics ? settings_.metrics_port : settings_.port;
      if (port < 0) continue;
      if (const auto error = loop_.listen(settings_.host, port, for_metrics)) {
        return fmt::format("cannot listen on {} port {}: {}", settings_.host, port, *error);
      }
    }
    // One more than compute at once, so that one is always free for short tasks.
    workers_.start(places() + 1);
    running_ = true;
    thread_ = std::thread([this] {
      {
        const CancellationWatch::Attended attended;
        loop_.run([this] {
          admission_.look();
          CancellationWatch::look_at_all();
          memory_watch_.look(lifecycle_.memory);
        });
      }
      const std::lock_guard lock(mutex_);
      running_ = false;
      ended_.notify_all();
    });
    return std::nullopt;
  } catch (const std::system_error& e) {
    return fmt::format("cannot start the threads that a service needs: {}", e.what());
  }

  std::string url() const {
    const bool six = settings_.host.find(':') != std::string::npos;
    return fmt::format("http://{}{}{}:{}", six ? "[" : "", settings_.host, six ? "]" : "", loop_.port());
  }
  int port() const { return loop_.port(); }
  bool running() const {
    const std::lock_guard lock(mutex_);
    return running_;
  }

  void stop() {
    if (!thread_.joinable()) return;
    lifecycle_.leaving = true;
    {
      std::unique_lock lock(mutex_);
      ended_.wait_for(lock, std::chrono::duration<double>(settings_.drain), [this] { return !running_ || hurries_; });
    }
    lifecycle_.draining = true;
    loop_.wake();
    {
      std::unique_lock lock(mutex_);
      ended_.wait_for(lock, std::chrono::duration<double>(settings_.grace), [this] { return !running_; });
    }
    lifecycle_.cancelled = true;
    admission_.close();
    thread_.join();
    workers_.finish();
  }

  void hurry() {
    const std::lock_guard lock(mutex_);
    hurries_ = true;
    ended_.notify_all();
  }

 private:
  unsigned places() const {
    return std::max(settings_.threads > 0 ? settings_.threads : std::thread::hardware_concurrency(), 1u);
  }

  // ---- calls by the loop

  ExchangePtr begin(Message message, Peer& peer, Line line) override {
    const std::string client = client_of(message.head, peer.address, settings_.trusted_proxies);
    if (client != peer.account->address()) peer.account = std::make_shared<Account>(client);
    message.for_metrics = peer.for_metrics;
    const ExchangePtr exchange = exchange_of(std::move(message), peer.account, std::move(line));
    const Message& request = exchange->message;
    const Effort effort = router_.effort(request.head, request.body);
    if (router_.is_short(request.head, effort)) {
      answer(exchange);
    } else {
      workers_.post(effort, [this, exchange] { answer(exchange); });
    }
    return exchange;
  }

  ExchangePtr refuse(Refused refused, const Peer& peer, Line line) override {
    Message message;
    message.head.method = std::move(refused.method);
    message.keep_alive = false;
    const ExchangePtr exchange = exchange_of(std::move(message), peer.account, std::move(line));
    Answer answer = error_(refused.refusal.status, refused.refusal.detail, exchange->id);
    if (answer.status == 503) answer.headers.emplace_back("Retry-After", "1");
    respond(exchange, "refused", std::move(answer));
    return exchange;
  }

  void go_on(const ExchangePtr& exchange) override {
    if (exchange->writing.exchange(true)) return;
    workers_.post(Effort::work,
                  [this, exchange] { guarded(exchange, [&] { AnswerWriter::write_pieces(*exchange); }); });
  }

  void aborted(const std::string& address) noexcept override try {
    LogLine(spdlog::level::info, "aborted").with("client", address);
  } catch (const std::bad_alloc&) {  // a line is lost
  }

  void left(const Exchange& exchange) noexcept override {
    if (exchange.computing) metrics_.cancelled();
  }

  bool busy() const override { return exchanges_ > 0; }

  ExchangePtr exchange_of(Message message, const AccountPtr& account, Line line) {
    auto id = request_id_of(message.head);
    if (!id) id = fmt::format(FMT_COMPILE("{:08x}-{:x}"), origin_, ++count_);
    auto exchange = std::make_shared<Exchange>(std::move(message), std::move(*id), account, std::move(line));
    ++exchanges_;
    exchange->ended = [this](const Exchange& over) {
      log(over);
      --exchanges_;
    };
    return exchange;
  }

  // ---- the way to an answer, on any thread

  void answer(const ExchangePtr& exchange) {
    guarded(exchange, [&] {
      const Exchange* const known = exchange.get();
      const auto gone = [known] { return known->left.load(); };
      auto [outcome, route] =
          router_(exchange->message.head, {exchange->message.body, exchange->message.head.field("accept"), exchange->id,
                                           gone, exchange->client->address(), exchange->message.for_metrics});
      if (auto* const ready = std::get_if<Answer>(&outcome)) {
        router_.dress(exchange->message.head, route, *ready);
        respond(exchange, route, std::move(*ready));
      } else {
        enqueue(exchange, route, std::move(std::get<Job>(outcome)));
      }
    });
  }

  void enqueue(const ExchangePtr& exchange, std::string_view route, Job job) {
    exchange->computing = true;
    if (auto pass = admission_.enter(exchange->client)) return compute(exchange, route, job, std::move(*pass), {});
    const auto from = Clock::now();
    const auto gone = [exchange] { return exchange->left.load(); };
    admission_.wait(exchange->client, Admission::patience, gone, [=, this](std::optional<Admission::Pass> pass) {
      guarded(exchange, [&] {
        const Effort effort = pass ? Effort::work : Effort::brief;
        const auto shared = std::make_shared<std::optional<Admission::Pass>>(std::move(pass));
        workers_.post(effort, [=, this] {
          if (*shared) return compute(exchange, route, job, *std::exchange(*shared, std::nullopt), Clock::now() - from);
          turn_away(exchange, route);
        });
      });
    });
  }

  void compute(const ExchangePtr& exchange, std::string_view route, const Job& job, Admission::Pass pass,
               Clock::duration queued) {
    guarded(exchange, [&] {
      exchange->place = pass.ticket();
      // An answer is charged before it is made: its text, or as much of it as is in memory at once.
      if (!holds(exchange, most_of_a_stream)) return respond(exchange, route, no_memory(exchange), queued);
      Answer computed = job(std::move(pass));
      router_.dress(exchange->message.head, route, computed);
      respond(exchange, route, std::move(computed), queued);
    });
  }

  void turn_away(const ExchangePtr& exchange, std::string_view route) {
    guarded(exchange, [&] {
      Answer busy = error_(503, "no place to compute becomes free in time: Retry-After says when", exchange->id);
      busy.headers.emplace_back("Retry-After", std::to_string(admission_.retry_after(exchange->client)));
      router_.dress(exchange->message.head, route, busy);
      respond(exchange, route, std::move(busy));
    });
  }

  // guarded answers exceptions with 500, as long as nothing has been sent; after that the answer breaks off.
  template <class Act>
  void guarded(const ExchangePtr& exchange, Act&& act) noexcept {
    const HeldByThread held(lifecycle_.memory);
    try {
      act();
    } catch (const MemoryShortage& e) {
      exchange->status == 0 ? turn_away_for_memory(exchange) : fail(exchange, e.what());
    } catch (const std::exception& e) {
      fail(exchange, e.what());
    } catch (...) {
      fail(exchange, "unknown");
    }
  }

  void turn_away_for_memory(const ExchangePtr& exchange) noexcept {
    try {
      exchange->computing = exchange->has_pieces = false;
      const bool alone = exchanges_ == 1;  // to ask again would not help
      respond(exchange, "failed",
              alone ? error_(422, beyond_memory(*lifecycle_.memory), exchange->id) : no_memory(exchange));
    } catch (const std::exception& e) {
      fail(exchange, e.what());
    }
  }

  void fail(const ExchangePtr& exchange, std::string_view why) noexcept {
    exchange->computing = exchange->has_pieces = false;
    const bool begun = exchange->status != 0;
    try {
      LogLine(spdlog::level::err, begun ? "failed while it was answered" : "failed")
          .with("id", exchange->id)
          .with("why", std::string(why));
      if (!begun) return respond(exchange, "failed", error_(500, "", exchange->id));
    } catch (...) {  // there is not even memory for that
    }
    exchange->outbox.finish(false);
  }

  // holds charges so many bytes to a request, until its answer has been sent, beyond what it holds already; it tells
  // whether there is memory. Small amounts are always granted, for probes and refusals.
  bool holds(const ExchangePtr& exchange, std::size_t bytes) {
    return bytes <= RequestReader::small || exchange->outbox.hold(lifecycle_.memory, bytes);
  }
  Answer no_memory(const ExchangePtr& exchange) const {
    Answer answer = error_(503, full_memory(*lifecycle_.memory), exchange->id);
    answer.headers.emplace_back("Retry-After", "1");
    return answer;
  }

  void respond(const ExchangePtr& exchange, std::string_view route, Answer answer, Clock::duration queued = {}) {
    const RequestHead& head = exchange->message.head;
    const bool unbounded = answer.stream || answer.pieces;
    const std::size_t bytes = unbounded ? most_of_a_stream : head.method == "HEAD" ? 0 : answer.body.size();
    if (!holds(exchange, bytes)) return respond(exchange, route, no_memory(exchange), queued);
    const std::chrono::duration<double, std::milli> passed = Clock::now() - exchange->start - queued;
    answer.headers.emplace_back("Date", http_date());
    answer.headers.emplace_back("X-Request-Id", exchange->id);
    answer.headers.emplace_back("Server-Timing",
                                fmt::format(FMT_COMPILE("compute;dur={:.3f}"), std::max(passed.count(), 0.0)));
    metrics_.answered(route, answer.status);
    exchange->route = route;
    exchange->status = answer.status;
    exchange->notes = answer.notes;
    exchange->chunked = unbounded && head.minor > 0;
    exchange->bare = unbounded && head.minor == 0;
    exchange->begins = answer.begins;
    // After a POST without a length, following bytes may be its intended body and not the next request. While others
    // cannot be accepted, clients inside make room.
    exchange->keep_alive = exchange->message.keep_alive && !lifecycle_.leaving && !lifecycle_.crowded &&
                           answer.status != 411 && (!unbounded || exchange->chunked);
    std::string text = head_of(answer, exchange->keep_alive, exchange->chunked);
    if (answer.stream) {
      writer_.stream(*exchange, answer, std::move(text));
    } else if (answer.pieces) {
      exchange->computing = false;
      exchange->pieces = std::move(answer.pieces);
      exchange->writing = exchange->has_pieces = true;
      if (exchange->outbox.put(std::move(text))) AnswerWriter::write_pieces(*exchange);
    } else {
      exchange->computing = false;
      if (head.method != "HEAD") {
        exchange->bytes = answer.body.size();
        text += answer.body;
      }
      AnswerWriter::finish(*exchange, std::move(text), exchange->keep_alive);
    }
  }

  // count_run counts a run by its scheme; studies and limits have several.
  void count_run(const Exchange& over) {
    if (over.status != 200 || over.place.number == 0) return;
    std::string scheme = "several";
    if (over.notes) {
      for (const Note& note : *over.notes)
        if (note.name == "scheme") scheme = std::get<std::string>(note.value);
    }
    metrics_.computed(over.route, scheme);
  }

  void log(const Exchange& over) try {
    if (over.status == 0) return;
    count_run(over);
    const std::chrono::duration<double, std::milli> time = (over.sent ? over.over : Clock::now()) - over.start;
    const std::string& method = over.message.head.method;
    LogLine line(spdlog::level::info, "request");
    line.with("id", over.id).with("method", method.empty() ? "-" : method).with("route", std::string(over.route));
    line.with("status", std::int64_t{over.status}).with("ms", std::round(time.count() * 1e3) / 1e3);
    line.with("bytes", static_cast<std::int64_t>(over.bytes)).with("client", over.client->address());
    if (!over.sent) line.with("aborted", over.left ? "the client left" : "unsent");
    if (over.notes) {
      for (const Note& note : *over.notes) line.with(note.name, note.value);
    }
  } catch (const std::bad_alloc&) {  // a line is lost
  }

  const HttpSettings settings_;
  const ErrorAnswer error_;
  const std::uint32_t origin_ = std::random_device{}();
  std::atomic<std::uint64_t> count_{0};
  std::atomic<int> exchanges_{0};
  Lifecycle lifecycle_;
  Metrics metrics_;
  Admission admission_;
  Router router_;
  EventLoop loop_;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  bool running_ = false, hurries_ = false;
  AnswerWriter writer_{workers_, admission_};
  MemoryWatch memory_watch_{workers_, settings_.alone ? MemoryWatch::resident_bytes : nullptr};
  Workers workers_;  // last, as its tasks use the other members
};

HttpServer::HttpServer(HttpSettings settings, ErrorAnswer error, MemoryBudget* memory)
    : impl_(std::make_unique<Impl>(std::move(settings), error, memory)) {}
HttpServer::~HttpServer() { stop(); }
Router& HttpServer::router() { return impl_->router(); }
Admission& HttpServer::admission() { return impl_->admission(); }
const Admission& HttpServer::admission() const { return impl_->admission(); }
Metrics& HttpServer::metrics() { return impl_->metrics(); }
bool HttpServer::leaving() const { return impl_->leaving(); }
std::size_t HttpServer::connections() const { return impl_->connections(); }
int HttpServer::metrics_port() const { return impl_->metrics_port(); }
const HttpSettings& HttpServer::settings() const { return impl_->settings(); }
const std::atomic<bool>& HttpServer::cancelled() const { return impl_->cancelled(); }
std::optional<std::string> HttpServer::start() { return impl_->start(); }
std::string HttpServer::url() const { return impl_->url(); }
int HttpServer::port() const { return impl_->port(); }
bool HttpServer::running() const { return impl_->running(); }
void HttpServer::stop() { impl_->stop(); }
void HttpServer::hurry() { impl_->hurry(); }

}  // namespace least::server
