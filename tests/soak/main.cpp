// soak [SECONDS]: the built service with every kind of client at once, for ten minutes unless told otherwise. Prints a
// table of what they met; exit code 1 where a bound was exceeded.
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <future>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/process.hpp"
#include "tests/soak/heavy.hpp"

namespace {

using namespace std::chrono_literals;
using namespace least::server::test;
using Clock = std::chrono::steady_clock;

constexpr std::size_t budget = std::size_t{256} << 20;  // bytes that answers may hold

// Waits in seconds, of one kind of client.
class Waits {
 public:
  void add(double seconds) {
    const std::lock_guard lock(mutex_);
    all_.push_back(seconds);
  }
  std::size_t count() const { return all_.size(); }
  double quantile(double q) {
    if (all_.empty()) return 1e9;
    std::sort(all_.begin(), all_.end());
    return all_[static_cast<std::size_t>(q * static_cast<double>(all_.size() - 1))];
  }

 private:
  std::mutex mutex_;
  std::vector<double> all_;
};

struct Counts {
  std::atomic<long> served{0}, busy{0}, lost{0}, wrong{0}, downloads{0}, aborted{0}, studies{0}, let_go{0};
};

class Soak {
 public:
  explicit Soak(double seconds)
      : service_({"serve", "--port", "0", "--max-memory", std::to_string(budget)}, "", {}, 2),
        port_(port_in(service_.line())),
        heavy_(port_, ending_) {
    std::vector<std::jthread> clients;
    const auto start = [&](int n, auto work) {
      for (int i = 0; i < n; ++i) clients.emplace_back([this, i, work] { (this->*work)(i); });
    };
    start(1, &Soak::drip_requests);
    start(64, &Soak::ask_on_and_on);
    start(8, &Soak::download);
    start(4, &Soak::leave);
    start(2, &Soak::study);
    start(1, &Soak::look_at_health);
    start(1, &Soak::run_now_and_then);
    start(2, &Soak::explode);
    start(1, &Soak::cut);
    start(slow_readers, &Soak::read_slowly);
    const auto until = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < until) {
      most_memory_ = std::max(most_memory_, status("VmRSS:"));
      most_threads_ = std::max(most_threads_, status("Threads:"));
      std::this_thread::sleep_for(100ms);
    }
    // The last requests: computing, and read in part, when the end comes.
    Client computing(port_), downloading(port_);
    computing.send(post("/v1/simulate", long_run("30")));
    downloading.send(post("/v1/simulate", large_run));
    std::this_thread::sleep_for(500ms);
    service_.signal(SIGTERM);
    ending_ = true;
    const auto from = Clock::now();
    // Who competes with so many may have been told to come again: that is an answer, too.
    auto downloaded = std::async(std::launch::async, [&] { return downloading.receive().has_value(); });
    ended_well_ = computing.receive().has_value();
    ended_well_ = downloaded.get() && ended_well_;
    exit_code_ = service_.wait();
    seconds_to_end_ = std::chrono::duration<double>(Clock::now() - from).count();
  }

  bool report(double seconds) {
    bool good = true;
    const char* const commit = std::getenv("LEAST_COMMIT");
    std::printf(
        "# Every kind of client at once\n\n%.0f s on %u cores that the clients share; commit %s. Written by `./dev "
        "soak "
        "--write`.\n\n",
        seconds, std::thread::hardware_concurrency(), commit ? commit : "unknown");
    const auto row = [&](const char* what, double value, const char* unit, double most) {
      std::printf("| %s | %.4g %s | %.4g |\n", what, value, unit, most);
      good = good && value <= most;
    };
    std::printf("| | measured | at most |\n|---|---|---|\n");
    row("/healthz, 99 of 100 within", health_.quantile(0.99) * 1e3, "ms", 50);
    // No run loses its place: a small run waits for the end of one of an explosive scene or a section, up to half a
    // second.
    row("a small run of one client, 99 of 100 within", small_.quantile(0.99) * 1e3, "ms", 500);
    row("the longest wait of 64 clients in a closed loop", waits_.quantile(1), "s", 2);
    row("memory beyond the budget of answers", (most_memory_ * 1024 - static_cast<double>(budget)) / 1e6, "MB", 100);
    // A worker for each core and four more; one for each client of lines that may be behind, including two of the
    // downloads; and the threads of ensembles, of which as many compute at once as there are cores, each with as many
    // threads.
    const double cores = std::thread::hardware_concurrency();
    row("threads", most_threads_, "", cores + 4 + 2 + slow_readers + cores * cores);
    row("an explosive scene, beyond the 0.1 s asked for", heavy_.explosive.longest(), "s", 1);
    row("a large section, beyond its limit of 1 s", heavy_.sections.longest(), "s", 1);
    row("answers read slowly that are cut off or wrong", static_cast<double>(heavy_.cut_off), "", 0);
    row("answers cut off or wrong", static_cast<double>(counts_.wrong + heavy_.wrong), "", 0);
    row("requests without an answer before the end", static_cast<double>(counts_.lost + heavy_.lost), "", 0);
    row("requests without an answer at the end", ended_well_ ? 0 : 1, "", 0);
    row("the end", seconds_to_end_, "s", 30);
    row("exit code", exit_code_, "", 0);
    std::printf(
        "\n%ld runs served, %ld told to come again; %zu probes, %zu small runs; %ld downloads, %ld studies, "
        "%ld runs left, %ld slow clients let go; %ld answers of explosive scenes, %ld sections; %ld answers read "
        "slowly to their end, %ld ended early\n",
        counts_.served.load(), counts_.busy.load() + heavy_.told_to_come_again, health_.count(), small_.count(),
        counts_.downloads.load(), counts_.studies.load(), counts_.aborted.load(), counts_.let_go.load(),
        heavy_.explosive.count(), heavy_.sections.count(), heavy_.read_whole.load(), heavy_.ended_early.load());
    return good;
  }

 private:
  static constexpr int slow_readers = 3;
  static constexpr const char* large_run =
      R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":400000},"record":{"every":1}})";
  static std::string long_run(const std::string& seconds) {
    return R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},"record":{"every":0},
      "limits":{"steps":10000000000,"seconds":)" +
           seconds + "}}";
  }

  // ask_for() takes one answer, and its time where `waits` is given. It returns false where the connection is over.
  bool ask_for(Client& client, const std::string& request, Waits* waits, bool runs) {
    const auto from = Clock::now();
    if (!client.send(request)) return false;
    const auto reply = client.receive();
    if (!reply) {
      // An idle connection may be closed while a request is on its way, but not within an answer.
      if (!ending_) ++counts_.lost;
      return false;
    }
    if (waits) waits->add(std::chrono::duration<double>(Clock::now() - from).count());
    if (reply->status == 503) ++counts_.busy;
    if (reply->status == 200 && runs) ++counts_.served;
    if (reply->status == 200 && reply->body.empty()) ++counts_.wrong;
    if (reply->status != 200 && reply->status != 503) ++counts_.wrong;
    return reply->fields.at("connection") == "keep-alive";
  }

  // Five hundred clients that send a byte of a request head now and then.
  void drip_requests(int) {
    std::list<Client> slow;
    const std::string request = get("/healthz");
    for (std::size_t n = 0; !ending_; ++n) {
      while (slow.size() < 500) slow.emplace_back(port_);
      for (auto client = slow.begin(); client != slow.end();) {
        const bool kept = client->send(std::string_view(request).substr(n % 30, 1));
        if (!kept) ++counts_.let_go;
        client = kept ? std::next(client) : slow.erase(client);
      }
      std::this_thread::sleep_for(500ms);
    }
  }
  void ask_on_and_on(int i) {
    const std::string request = post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":)" +
                                                         std::to_string(10 << i % 12) + "}}");
    while (!ending_) {
      Client client(port_);
      while (!ending_ && ask_for(client, request, &waits_, true)) {
      }
    }
  }
  void download(int i) {
    constexpr const char* forms[] = {"", "Accept: text/csv\r\n", "Accept: application/cbor\r\n",
                                     "Accept: application/x-ndjson\r\n"};
    while (!ending_) {
      Client client(port_);
      // Four read slowly, twice as fast as they have to; one of these is of a run that waits for its reader, and lends
      // its place and thread.
      client.send(post("/v1/simulate", large_run, forms[i % 4]));
      if (i >= 4) {
        while (!ending_ && client.some(1300)) std::this_thread::sleep_for(10ms);
      } else if (const auto reply = client.receive(); reply && reply->status == 200) {
        ++counts_.downloads;
        if (reply->body.size() < 10'000'000) ++counts_.wrong;
      } else if (!reply && !ending_) {
        ++counts_.wrong;
      }
    }
  }
  void leave(int i) {
    while (!ending_) {
      Client client(port_);
      client.send(post("/v1/simulate", long_run("20"), i % 2 ? "Accept: application/x-ndjson\r\n" : ""));
      std::this_thread::sleep_for(100ms);
      if (i < 2) client.reset();
      ++counts_.aborted;
    }
  }
  void study(int) {
    const std::string request = post(
        "/v1/work-precision", R"({"problem":"kepler","until":{"t":20},"schemes":["leapfrog"],"budget_seconds":0.2})");
    while (!ending_) {
      Client client(port_);
      ask_for(client, request, nullptr, false);
      ++counts_.studies;
      std::this_thread::sleep_for(500ms);
    }
  }
  void explode(int i) { heavy_.ask_for_explosive_scenes(20 * i); }
  void cut(int i) { heavy_.ask_for_sections(i); }
  void read_slowly(int i) { heavy_.read_slowly(i); }
  void look_at_health(int) { every_while("127.0.0.3", get("/healthz"), health_); }
  void run_now_and_then(int) {
    every_while("127.0.0.2", post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":100}})"),
                small_);
  }
  void every_while(const char* from, const std::string& request, Waits& waits) {
    while (!ending_) {
      Client client(port_, from);
      while (!ending_ && ask_for(client, request, &waits, false)) std::this_thread::sleep_for(20ms);
    }
  }

  // status() returns a number of /proc/…/status; kibibytes where it is memory.
  double status(const std::string& name) const {
    std::ifstream file("/proc/" + std::to_string(service_.id()) + "/status");
    double value = 0;
    for (std::string word; file >> word;) {
      if (word == name && file >> value) break;
    }
    return value;
  }

  Process service_;
  const int port_;
  std::atomic<bool> ending_{false};
  HeavyClients heavy_;
  Waits health_, small_, waits_;
  Counts counts_;
  double most_memory_ = 0, most_threads_ = 0, seconds_to_end_ = 0;
  bool ended_well_ = false;
  int exit_code_ = -1;
};

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::stod(argv[1]) : 600;
  Soak soak(seconds);
  return soak.report(seconds) ? 0 : 1;
}
