// How an answer gets on its way: whole, piece by piece as there is room, or as it is computed.
#pragma once

#include <string>

#include "server/http/admission.hpp"
#include "server/http/exchange.hpp"
#include "server/http/workers.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

/// Called by a worker, for one exchange at a time. What an endpoint throws comes through.
class AnswerWriter {
 public:
  AnswerWriter(Workers& workers, Admission& admission) : workers_(workers), admission_(admission) {}

  /// The last of an answer; `keeps`: its connection is for a further one.
  static void finish(Exchange& exchange, std::string last, bool keeps = false);
  /// Behind its head what is computed meanwhile. Each piece leaves at once, or when the client has taken what was
  /// before it; the end is not waited for.
  void stream(Exchange& exchange, const Answer& answer, std::string head);
  /// As much of the rest as there is room for. Whoever makes room meanwhile leaves it to this thread, or posts it
  /// again.
  static void write_pieces(Exchange& exchange);

 private:
  bool let_others(Exchange& exchange);

  Workers& workers_;
  Admission& admission_;
};

}  // namespace least::server
