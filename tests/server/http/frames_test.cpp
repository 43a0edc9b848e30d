// Pages of other origins that hold the page in a frame.
#include <gtest/gtest.h>
#include <signal.h>

#include <string>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/server/process.hpp"

namespace least::server::test {
namespace {

// framed() is the request of a browser that puts the page into a frame of a page of this origin.
std::string framed(const std::string& origin, const std::string& path = "/") {
  return get(path, "Sec-Fetch-Dest: iframe\r\nAccept: text/html,*/*;q=0.8\r\n" +
                       (origin.empty() ? "" : "Referer: " + origin + "/lecture.html\r\n"));
}

std::string policy_of(const Reply& reply) { return reply.fields.at("content-security-policy"); }

class Frames : public testing::Test {
 protected:
  explicit Frames(std::vector<std::string> allowed = {}) {
    Settings settings = quiet_settings();
    settings.allow_frames = std::move(allowed);
    service_ = std::make_unique<Service>(settings, page_assets);
    EXPECT_FALSE(service_->start());
  }
  Reply asked(const std::string& request) const { return ask(service_->port(), request); }

 private:
  std::unique_ptr<Service> service_;
};

TEST_F(Frames, NonesAreAllowedUnlessTheServiceIsTold) {
  EXPECT_NE(policy_of(asked(get("/"))).find("frame-ancestors 'none';"), std::string::npos);
  const Reply refused = asked(framed("https://course.example"));
  EXPECT_EQ(refused.status, 403);
  EXPECT_NE(refused.body.find("--allow-frame"), std::string::npos) << "whoever embeds reads which option it takes";
  EXPECT_EQ(refused.fields.at("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(policy_of(refused), "default-src 'none'") << "it may be seen in the frame";
  EXPECT_EQ(asked(framed("")).status, 403) << "none is allowed, whoever it may be";
  EXPECT_EQ(asked(framed("", "/v1/problems")).status, 200) << "the policy is that of the page";
}

struct AllowedFrames : Frames {
  AllowedFrames() : Frames({"https://course.example", "http://127.0.0.1:9000"}) {}
};

TEST_F(AllowedFrames, ArePagesOfTheOriginsGiven) {
  const Reply page = asked(framed("https://course.example"));
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, page_text);
  EXPECT_NE(policy_of(page).find("frame-ancestors https://course.example http://127.0.0.1:9000;"), std::string::npos);
  EXPECT_EQ(asked(framed("HTTP://127.0.0.1:9000")).status, 200);
  EXPECT_EQ(asked(framed("")).status, 200) << "the browser knows who embeds, and keeps to the policy";
  for (const char* other : {"https://course.example:8443", "http://course.example", "https://course.example.evil"})
    EXPECT_EQ(asked(framed(other)).status, 403) << other;
}

TEST(FrameOption, TakesOriginsAndNothingElse) {
  for (const char* none : {"course.example", "https://course.example/", "https://*", "https://a b", "https://a;x",
                           "https://a:123456", "'self'", "null", ""}) {
    for (const auto& [arguments, environment] :
         {std::pair{std::vector<std::string>{"serve", "--port", "0", "--allow-frame", none},
                    std::vector<std::string>{}},
          std::pair{std::vector<std::string>{"serve", "--port", "0"},
                    std::vector<std::string>{"LEASTACTION_ALLOW_FRAME=" + std::string(none)}}}) {
      if (std::string_view(none).empty() && !environment.empty()) continue;  // a variable that is empty says nothing
      Process serve(arguments, "", environment);
      const std::string errors = serve.errors();
      EXPECT_NE(errors.find(environment.empty() ? "--allow-frame: " : "LEASTACTION_ALLOW_FRAME: "), std::string::npos)
          << errors;
      EXPECT_NE(errors.find("as https://example.org"), std::string::npos) << errors;
      EXPECT_EQ(serve.wait(), 1) << none;
    }
  }
  Process origin({"serve", "--port", "0", "--allow-origin", "friend.example"});
  EXPECT_NE(origin.errors().find("is no origin"), std::string::npos);
  EXPECT_EQ(origin.wait(), 1);
  Process serve({"serve", "--port", "0", "--allow-frame", "HTTPS://Course.example", "--allow-frame", "http://[::1]:80",
                 "--allow-origin", "null"});
  const Reply page = ask(port_in(serve.line()), get("/"));
  EXPECT_NE(policy_of(page).find("frame-ancestors https://course.example http://[::1]:80;"), std::string::npos);
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
}

}  // namespace
}  // namespace least::server::test
