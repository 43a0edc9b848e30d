// Properties that hold for all bytes: each target takes any bytes, and throws where its property fails. `./dev fuzz`
// looks for bytes that break one; corpora_test.cpp runs the targets over the bytes that were kept.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace least::fuzz {

/// guard() takes the bytes of a client: however they are cut, they give the same requests within their bounds, and what
/// was accepted as a request is one when it is written down strictly.
void guard(std::string_view bytes);

/// request() takes JSON: an accepted request is echoed as one that is read as the same; a refused one is refused in a
/// document.
void request(std::string_view bytes);

/// accept() takes a field `Accept`: the best of the offered forms is chosen, whatever else is offered.
void accept(std::string_view bytes);

/// forms() takes numbers and a text: JSON, CBOR and lines say the same of them.
void forms(std::string_view bytes);

/// formula() takes a formula: printed from its tape and read again it has the same value, its faults lie within it, and
/// its MathML is well-formed.
void formula(std::string_view bytes);

/// values() takes choices of which values of a good request are replaced, and by what. An accepted request runs, for a
/// short time, as in the service: the answer is whole, and a refusal says why.
void values(std::string_view bytes);
/// status_of_values() returns the status of that answer; 0 where this build leaves out what the request needs.
int status_of_values(std::string_view bytes);

struct Target {
  std::string_view name;  ///< also of its folder in tests/fuzz/corpus
  void (*check)(std::string_view bytes);
};
inline constexpr Target targets[] = {{"guard", guard}, {"request", request}, {"accept", accept},
                                     {"forms", forms}, {"formula", formula}, {"values", values}};

inline void ensure(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

}  // namespace least::fuzz
