// Sends an answer: whole, piece by piece as there is room, or while it is computed.
#pragma once

#include <string>

#include "server/http/admission.hpp"
#include "server/http/exchange.hpp"
#include "server/http/workers.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

/// AnswerWriter is used by workers, each for one exchange at a time. Exceptions of endpoints pass through it.
class AnswerWriter {
 public:
  AnswerWriter(Workers& workers, Admission& admission) : workers_(workers), admission_(admission) {}

  /// finish sends the end of an answer; `keeps`: the connection stays open for a further request.
  static void finish(Exchange& exchange, std::string last, bool keeps = false);
  /// stream sends the head, then the body while it is computed: each piece at once, or when the client has taken the
  /// previous ones. It does not wait for the end to be taken.
  void stream(Exchange& exchange, const Answer& answer, std::string head);
  /// write_pieces writes as much of the rest as there is room for. A thread that makes room meanwhile leaves the rest
  /// to this one, or posts it again.
  static void write_pieces(Exchange& exchange);

 private:
  bool let_others(Exchange& exchange);

  Workers& workers_;
  Admission& admission_;
};

}  // namespace least::server
