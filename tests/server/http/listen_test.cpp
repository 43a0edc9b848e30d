// A service that cannot listen says why: with the error of the system call that failed.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

// let_fail() makes one system call of this thread fail with this error from now on. False: the machine allows no
// filters of system calls.
bool let_fail(unsigned call, unsigned error) {
  std::array<sock_filter, 4> rules{
      sock_filter{BPF_LD | BPF_W | BPF_ABS, 0, 0, offsetof(seccomp_data, nr)},
      sock_filter{BPF_JMP | BPF_JEQ | BPF_K, 0, 1, call},
      sock_filter{BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ERRNO | error},
      sock_filter{BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW},
  };
  const sock_fprog program{rules.size(), rules.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

// said_without() returns what a service says that starts on a thread on which a system call fails; nothing where no
// call can be made to fail.
std::optional<std::string> said_without(unsigned call, unsigned error) {
  std::optional<std::string> said;
  std::thread([&] {
    Service service(quiet_settings(), page_assets);
    if (let_fail(call, error)) said = service.start().value_or("it started");
  }).join();
  return said;
}

TEST(Listening, SaysWhyItIsImpossible) {
  constexpr struct {
    unsigned call, error;
  } rows[] = {{SYS_socket, EAFNOSUPPORT},  // as of a host with an IPv6 address, on a machine without IPv6
              {SYS_bind, EADDRNOTAVAIL},
              {SYS_listen, EADDRINUSE},
              {SYS_epoll_ctl, ENOSPC}};
  for (const auto& [call, error] : rows) {
    const auto said = said_without(call, error);
    if (!said) GTEST_SKIP() << "no system call can be made to fail here";
    EXPECT_EQ(*said, "cannot listen on 127.0.0.1 port 0: " + std::string(std::strerror(static_cast<int>(error))));
  }
}

}  // namespace
}  // namespace least::server::test
