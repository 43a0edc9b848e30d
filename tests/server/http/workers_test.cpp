// The order in which tasks are done.
#include "server/http/workers.hpp"

#include <gtest/gtest.h>

#include <future>
#include <string>

namespace least::server {
namespace {

using namespace std::chrono_literals;

// order_after() returns the order in which one thread does tasks that were posted while it was busy for so long.
std::string order_after(std::chrono::milliseconds busy, bool late_brief = false) {
  std::string order;
  std::promise<void> begun, posted;
  Workers workers;
  workers.start(1);
  workers.post(Effort::work, [&] {
    begun.set_value();
    posted.get_future().wait();
  });
  begun.get_future().wait();
  const auto post = [&](Effort effort, char name) { workers.post(effort, [&order, name] { order += name; }); };
  post(Effort::work, 'w');
  post(Effort::reading, 'r');
  if (!late_brief) post(Effort::brief, 'b');
  post(Effort::work, 'W');
  post(Effort::reading, 'R');
  std::this_thread::sleep_for(busy);
  if (late_brief) post(Effort::brief, 'b');
  post(Effort::brief, 'B');
  posted.set_value();
  workers.finish();
  return order;
}

TEST(Workers, DoWhatIsBriefFirst) { EXPECT_EQ(order_after(0ms), "bBrRwW"); }

TEST(Workers, KeepNobodyWaitingForEverForWhatIsBrief) { EXPECT_EQ(order_after(2 * Workers::patience, true), "wrWRbB"); }

}  // namespace
}  // namespace least::server
