// A raw HTTP client: sends exactly the bytes it is given.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace least::server::test {

struct Reply {
  int status = 0;
  std::map<std::string, std::string> fields;  ///< names in lower case
  std::string body;
  std::vector<std::string> chunks;  ///< of a body that came in chunked coding
};

class Client {
 public:
  /// Connects to this machine, where `from` says so from that address of it; `buffer`: so many bytes the system takes
  /// for it ahead, as many as it likes where 0.
  explicit Client(int port, const char* from = nullptr, int buffer = 0);
  ~Client();
  Client(Client&& other) noexcept;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connected() const { return socket_ >= 0; }
  /// False when the service closed the connection meanwhile.
  bool send(std::string_view bytes);
  /// Says that nothing more will be sent.
  void end_sending();
  /// Closes the socket, as a process that ends.
  void hang_up();
  /// Ends the connection at once, by a reset.
  void reset();
  /// The status of an answer without fields and body, such as 100.
  int interim();
  /// The next answer; nothing when the connection ended first. `head`: it has no body.
  std::optional<Reply> receive(bool head = false);
  /// The next chunk of a body, empty at its end; nothing when the connection ended first or the coding is wrong.
  std::optional<std::string> chunk();
  /// What came, or comes next, so many bytes of it at most; nothing when the connection ended.
  std::optional<std::string> some(std::size_t most = 65536);
  /// What came, or comes next, and stays to be received.
  std::string_view peek();
  /// Whether nothing but the end of the connection comes any more (waits for it up to 20 s).
  bool ended();
  /// Whether the connection ends, after whatever comes, by a reset.
  bool ends_by_reset();

 private:
  bool fill(std::size_t most = 65536);
  int socket_ = -1;
  std::string buffer_;
};

std::string get(std::string_view path, std::string_view fields = "");
std::string post(std::string_view path, std::string_view body, std::string_view fields = "");

/// One request on a connection of its own. Status 0: no answer.
Reply ask(int port, std::string_view bytes, bool head = false);

}  // namespace least::server::test
