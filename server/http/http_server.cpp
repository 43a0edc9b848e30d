#include "server/http/http_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <random>
#include <thread>

#include "server/http/listener.hpp"

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
        admission_(settings_.threads > 0 ? settings_.threads : cores(), settings_.queue),
        router_(access_of(settings_), error),
        listener_(settings_.connections, lifecycle_.waiting, [this](int socket) { serve(socket); }) {}

  Router& router() { return router_; }
  Admission& admission() { return admission_; }
  const std::atomic<bool>& cancelled() const { return lifecycle_.cancelled; }

  std::optional<std::string> start() {
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
    try {
      while (answer_next(connection)) {
      }
    } catch (const std::exception& e) {
      spdlog::error("connection lost: {}", e.what());
    }
  }

  bool answer_next(Connection& connection) {
    auto received = connection.receive();
    if (std::holds_alternative<Gone>(received)) return false;
    const auto start = Clock::now();
    const std::string id = fmt::format("{:08x}-{:x}", origin_, ++count_);
    if (auto* refused = std::get_if<Refused>(&received)) {
      const Refusal& refusal = refused->refusal;
      Routed routed{error_(refusal.status, refusal.detail, id), "refused"};
      finish(connection, routed, id, refused->method, start, false, true);
      connection.linger();
      return false;
    }
    const auto& message = std::get<Message>(received);
    const Routed routed = answer(message, id, [&connection] { return connection.gone(); });
    // What follows a POST without a length may be the body its client had in mind: not the next request. In HTTP/1.0 a
    // stream ends with its connection.
    const bool keep_alive = message.keep_alive && !lifecycle_.draining && routed.answer.status != 411 &&
                            !(routed.answer.stream && message.head.minor == 0);
    const bool sent =
        finish(connection, routed, id, message.head.method, start, keep_alive, message.head.method != "HEAD");
    return sent && keep_alive;
  }

  Routed answer(const Message& message, const std::string& id, const std::function<bool()>& gone) {
    try {
      return router_(message.head, message.body, id, gone);
    } catch (const std::exception& e) {
      spdlog::error("request id={} failed: {}", id, e.what());
    } catch (...) {
      spdlog::error("request id={} failed", id);
    }
    return {error_(500, "", id), "failed"};
  }

  bool finish(Connection& connection, Routed routed, const std::string& id, std::string_view method,
              Clock::time_point start, bool keep_alive, bool body) {
    routed.answer.headers.emplace_back("X-Request-Id", id);
    bool sent = false;
    try {
      sent = connection.send(routed.answer, keep_alive, body);
    } catch (const std::exception& e) {
      spdlog::error("request id={} failed while it was answered: {}", id, e.what());
    }
    const std::chrono::duration<double, std::milli> time = Clock::now() - start;
    spdlog::info("request id={} method={} route={} status={} ms={:.3f} bytes={}{}", id, method.empty() ? "-" : method,
                 routed.route, routed.answer.status, time.count(), connection.sent(), sent ? "" : " unsent");
    return sent;
  }

  const HttpSettings settings_;
  const ErrorAnswer error_;
  const std::uint32_t origin_ = static_cast<std::uint32_t>(random_bits());
  std::atomic<std::uint64_t> count_{0};
  Lifecycle lifecycle_;
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
const std::atomic<bool>& HttpServer::cancelled() const { return impl_->cancelled(); }
std::optional<std::string> HttpServer::start() { return impl_->start(); }
std::string HttpServer::url() const { return impl_->url(); }
int HttpServer::port() const { return impl_->port(); }
bool HttpServer::running() const { return impl_->running(); }
void HttpServer::stop() { impl_->stop(); }

}  // namespace least::server
