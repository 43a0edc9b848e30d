// Addresses that proxies give for the clients behind them: only trusted proxies are believed.
#include "server/http/forwarded.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

RequestHead head_with(const std::string& name, const std::vector<std::string>& values) {
  RequestHead head;
  for (const std::string& value : values) head.fields.emplace_back(name, value);
  return head;
}

TEST(Forwarded, AddressesAreWrittenAsTheSystemDoes) {
  EXPECT_EQ(address_of("10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(address_of("FD00:0::1"), "fd00::1");
  EXPECT_EQ(address_of("::ffff:10.0.0.1"), "10.0.0.1");
  for (const char* none : {"", "10.0.0", "10.0.0.1:80", "unknown", "[::1]", "1.2.3.4 "})
    EXPECT_EQ(address_of(none), "");
}

TEST(Forwarded, TheLastThatIsNoProxyIsTheClient) {
  const std::vector<std::string> trusted{"127.0.0.1", "10.0.0.1"};
  const auto client = [&](const std::vector<std::string>& values, const char* peer = "127.0.0.1") {
    return client_of(head_with("x-forwarded-for", values), peer, trusted);
  };
  EXPECT_EQ(client({"1.2.3.4"}), "1.2.3.4");
  EXPECT_EQ(client({"1.2.3.4"}, "9.9.9.9"), "9.9.9.9") << "no proxy of ours: it may say what it likes";
  EXPECT_EQ(client({"6.6.6.6, 1.2.3.4"}), "1.2.3.4") << "what stands before it came from the client";
  EXPECT_EQ(client({"6.6.6.6", "1.2.3.4"}), "1.2.3.4");
  EXPECT_EQ(client({"1.2.3.4,10.0.0.1"}), "1.2.3.4");
  EXPECT_EQ(client({"10.0.0.1"}), "10.0.0.1");
  EXPECT_EQ(client({"1.2.3.4, rubbish"}), "127.0.0.1");
  EXPECT_EQ(client({"::FFFF:1.2.3.4"}), "1.2.3.4");
  EXPECT_EQ(client({","}), "127.0.0.1");
  EXPECT_EQ(client({}), "127.0.0.1");
}

TEST(Forwarded, ARequestIdIsKeptWhereItIsOne) {
  const auto id = [](const std::vector<std::string>& values) {
    return request_id_of(head_with("x-request-id", values)).value_or("none");
  };
  EXPECT_EQ(id({"a-B_3 {x}"}), "a-B_3 {x}");
  EXPECT_EQ(id({std::string(64, 'x')}), std::string(64, 'x'));
  for (const auto& values :
       {std::vector<std::string>{}, {""}, {std::string(65, 'x')}, {"a\tb"}, {"\xC3\xA4"}, {"a", "b"}})
    EXPECT_EQ(id(values), "none");
}

// A crowd behind a proxy, and a client with another address behind the same proxy.
TEST(Forwarded, ThoseBehindAProxyAreServedByTheirAddress) {
  Settings settings = quiet_settings();
  settings.threads = 1;
  settings.queue = 0;
  settings.trusted_proxies = {"127.0.0.1"};
  Service service(settings, page_assets);
  ASSERT_FALSE(service.start());
  const auto run = [](const std::string& address, const std::string& id) {
    return post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})",
                "X-Forwarded-For: " + address + "\r\nX-Request-Id: " + id + "\r\n");
  };
  const Reply kept = ask(service.port(), run("10.0.0.1", "seven-of-nine"));
  EXPECT_EQ(kept.fields.at("x-request-id"), "seven-of-nine");
  const Reply own = ask(service.port(), run("10.0.0.1", "\xC3\xA4"));
  EXPECT_EQ(own.status, 200);
  EXPECT_NE(own.fields.at("x-request-id"), "\xC3\xA4");
}

}  // namespace
}  // namespace least::server::test
