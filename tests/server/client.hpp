// A raw HTTP client, which sends exactly the bytes it is given.
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
  std::vector<std::string> chunks;  ///< the chunks of a body in chunked coding
};

class Client {
 public:
  /// Connects to the port on this machine, from the local address `from` if that is given. `buffer` limits the bytes
  /// that the system receives ahead of the reader; 0 leaves that to the system.
  explicit Client(int port, const char* from = nullptr, int buffer = 0);
  ~Client();
  Client(Client&& other) noexcept;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connected() const { return socket_ >= 0; }
  /// send() returns false when the service has closed the connection meanwhile.
  bool send(std::string_view bytes);
  /// end_sending() says that nothing more will be sent, and leaves the connection open for reading.
  void end_sending();
  /// hang_up() closes the socket, as a process that ends does.
  void hang_up();
  /// reset() ends the connection at once, by a TCP reset.
  void reset();
  /// interim() returns the status of a head without its fields and body, such as 100.
  int interim();
  /// receive() returns the next answer; nothing when the connection ended first. With `head` the answer has no body.
  std::optional<Reply> receive(bool head = false);
  /// chunk() returns the next chunk of a body, empty at its end; nothing when the connection ended first or the coding
  /// is wrong.
  std::optional<std::string> chunk();
  /// some() returns and removes bytes that have arrived or arrive next, `most` at most; nothing when the connection
  /// ended.
  std::optional<std::string> some(std::size_t most = 65536);
  /// peek() returns the bytes that have arrived or arrive next, and leaves them to be received.
  std::string_view peek();
  /// ended() says whether the end of the connection comes next, without further bytes (it waits up to 20 s).
  bool ended();
  /// ends_by_reset() says whether the connection, after whatever bytes come, ends by a reset.
  bool ends_by_reset();

 private:
  bool fill(std::size_t most = 65536);
  int socket_ = -1;
  std::string buffer_;
};

std::string get(std::string_view path, std::string_view fields = "");
std::string post(std::string_view path, std::string_view body, std::string_view fields = "");

/// ask() sends one request on a connection of its own. The status is 0 where there is no answer.
Reply ask(int port, std::string_view bytes, bool head = false);

}  // namespace least::server::test
