#include "server/http/http_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <random>
#include <system_error>
#include <thread>

#include "server/http/cancellation.hpp"
#include "server/http/http_date.hpp"
#include "server/http/listener.hpp"
#include "server/shared/log.hpp"

namespace least::server {
namespace {

using Clock = std::chrono::steady_clock;

unsigned cores() { return std::max(std::thread::hardware_concurrency(), 1u); }

Access access_of(const HttpSettings& settings) {
  Access access{settings.allow_hosts, settings.allow_origins};
  access.hosts.insert(access.hosts.end(), {"localhost", "127.0.0.1", "[::1]", settings.host});
  if (settings.host.find(':') != std::string::npos) access.hosts.push_back('[' + settings.host + ']');
  return access;
}

// The address of who is at the other end; empty where there is none.
std::string address_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  char text[INET6_ADDRSTRLEN] = "";
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return {};
  const void* number = nullptr;
  if (address.ss_family == AF_INET) number = &reinterpret_cast<const sockaddr_in&>(address).sin_addr;
  if (address.ss_family == AF_INET6) number = &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  if (number == nullptr || ::inet_ntop(address.ss_family, number, text, sizeof text) == nullptr) return {};
  return text;
}

std::uint64_t random_bits() {
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

}  // namespace

class HttpServer::Impl {
 public:
  Impl(HttpSettings settings, ErrorAnswer error)
      : settings_(std::move(settings)),
        error_(error),
        admission_(settings_.threads > 0 ? settings_.threads : cores(), settings_.queue, &metrics_),
        router_(access_of(settings_), error),
        listener_(settings_.connections, lifecycle_.waiting, [this](int socket) { serve(socket); }) {}

  Router& router() { return router_; }
  Admission& admission() { return admission_; }
  Metrics& metrics() { return metrics_; }
  bool draining() const { return lifecycle_.draining; }
  const std::atomic<bool>& cancelled() const { return lifecycle_.cancelled; }

  std::optional<std::string> start() try {
    CancellationWatch::prepare();
    if (const auto error = listener_.bind(settings_.host, settings_.port)) {
      return fmt::format("cannot listen on {} port {}: {}", settings_.host, settings_.port, *error);
    }
    running_ = true;
    thread_ = std::thread([this] {
      listener_.listen();
      {
        const std::lock_guard lock(mutex_);
        running_ = false;
      }
      ended_.notify_all();
    });
    return std::nullopt;
  } catch (const std::system_error& e) {
    return fmt::format("cannot start the threads that a service needs: {}", e.what());
  }

  std::string url() const {
    const bool six = settings_.host.find(':') != std::string::npos;
    return fmt::format("http://{}{}{}:{}", six ? "[" : "", settings_.host, six ? "]" : "",
                       settings_.port == 0 ? listener_.port() : settings_.port);
  }
  int port() const { return listener_.port(); }
  bool running() const {
    const std::lock_guard lock(mutex_);
    return running_;
  }

  void stop() {
    if (!thread_.joinable()) return;
    lifecycle_.draining = true;
    listener_.close();
    {
      std::unique_lock lock(mutex_);
      ended_.wait_for(lock, std::chrono::duration<double>(settings_.grace), [this] { return !running_; });
    }
    lifecycle_.cancelled = true;
    admission_.close();
    thread_.join();
  }

 private:
  // One connection, on its own thread.
  void serve(int socket) {
    Connection connection(socket, settings_.bounds, lifecycle_);
    const std::string client = address_of(socket);
    try {
      while (answer_next(connection, client)) {
      }
    } catch (const std::exception& e) {
      LogLine(spdlog::level::err, "connection lost").with("why", e.what());
    }
  }

  bool answer_next(Connection& connection, std::string_view client) {
    auto received = connection.receive();
    if (const auto* gone = std::get_if<Gone>(&received)) {
      if (gone->begun) LogLine(spdlog::level::info, "aborted").with("client", std::string(client));
      return false;
    }
    std::atomic<bool> left{false};
    const auto start = Clock::now();
    const std::string id = fmt::format("{:08x}-{:x}", origin_, ++count_);
    if (auto* refused = std::get_if<Refused>(&received)) {
      const Refusal& refusal = refused->refusal;
      Routed routed{error_(refusal.status, refusal.detail, id), "refused"};
      finish(connection, std::move(routed), {id, refused->method, start, 0, client, left}, false,
             refused->method != "HEAD");
      connection.linger();
      return false;
    }
    const auto& message = std::get<Message>(received);
    const auto gone = [&] {
      if (!left && connection.gone() && !left.exchange(true)) metrics_.cancelled();
      return left.load();
    };
    double queued = 0;
    Routed routed = answer(message, {message.body, {}, id, gone, client, &queued});
    const std::chrono::duration<double> passed = Clock::now() - start;
    // While others wait for a thread, nobody keeps one by asking again and again.
    const bool yields = lifecycle_.waiting > 0 && !connection.has_more();
    // What follows a POST without a length may be the body its client had in mind: not the next request. In HTTP/1.0 a
    // stream ends with its connection.
    const bool keep_alive = message.keep_alive && !lifecycle_.draining && !yields && routed.answer.status != 411 &&
                            !(routed.answer.stream && message.head.minor == 0);
    const bool sent = finish(connection, std::move(routed),
                             {id, message.head.method, start, std::max(passed.count() - queued, 0.0), client, left},
                             keep_alive, message.head.method != "HEAD");
    return sent && keep_alive;
  }

  Routed answer(const Message& message, const HttpRequest& request) {
    try {
      return router_(message.head, request);
    } catch (const std::exception& e) {
      LogLine(spdlog::level::err, "failed").with("id", std::string(request.id)).with("why", e.what());
    } catch (...) {
      LogLine(spdlog::level::err, "failed").with("id", std::string(request.id));
    }
    return {error_(500, "", request.id), "failed"};
  }

  // What is said about a request beside its answer. `compute`: seconds up to its first byte, without the queue.
  struct Handled {
    const std::string& id;
    std::string_view method;
    Clock::time_point start;
    double compute;
    std::string_view client;
    const std::atomic<bool>& left;  // the client went away meanwhile
  };

  bool finish(Connection& connection, Routed routed, const Handled& handled, bool keep_alive, bool body) {
    const auto& [id, method, start, compute, client, left] = handled;
    auto& headers = routed.answer.headers;
    headers.emplace_back("Date", http_date());
    headers.emplace_back("X-Request-Id", id);
    headers.emplace_back("Server-Timing", fmt::format("compute;dur={:.3f}", compute * 1e3));
    metrics_.answered(routed.route, routed.answer.status);
    bool sent = false;
    try {
      sent = connection.send(routed.answer, keep_alive, body);
    } catch (const std::exception& e) {
      LogLine(spdlog::level::err, "failed while it was answered").with("id", id).with("why", e.what());
    }
    const std::chrono::duration<double, std::milli> time = Clock::now() - start;
    LogLine line(spdlog::level::info, "request");
    line.with("id", id)
        .with("method", std::string(method.empty() ? "-" : method))
        .with("route", std::string(routed.route));
    line.with("status", std::int64_t{routed.answer.status}).with("ms", std::round(time.count() * 1e3) / 1e3);
    line.with("bytes", static_cast<std::int64_t>(connection.sent())).with("client", std::string(client));
    if (!sent) line.with("aborted", left ? "the client left" : "unsent");
    if (routed.answer.notes) {
      for (const Note& note : *routed.answer.notes) line.with(note.name, note.value);
    }
    return sent;
  }

  const HttpSettings settings_;
  const ErrorAnswer error_;
  const std::uint32_t origin_ = static_cast<std::uint32_t>(random_bits());
  std::atomic<std::uint64_t> count_{0};
  Lifecycle lifecycle_;
  Metrics metrics_;
  Admission admission_;
  Router router_;
  Listener listener_;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  bool running_ = false;
};

HttpServer::HttpServer(HttpSettings settings, ErrorAnswer error)
    : impl_(std::make_unique<Impl>(std::move(settings), error)) {}
HttpServer::~HttpServer() { stop(); }
Router& HttpServer::router() { return impl_->router(); }
Admission& HttpServer::admission() { return impl_->admission(); }
Metrics& HttpServer::metrics() { return impl_->metrics(); }
bool HttpServer::draining() const { return impl_->draining(); }
const std::atomic<bool>& HttpServer::cancelled() const { return impl_->cancelled(); }
std::optional<std::string> HttpServer::start() { return impl_->start(); }
std::string HttpServer::url() const { return impl_->url(); }
int HttpServer::port() const { return impl_->port(); }
bool HttpServer::running() const { return impl_->running(); }
void HttpServer::stop() { impl_->stop(); }

}  // namespace least::server
