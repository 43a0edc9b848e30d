// What holds whatever bytes come: each target takes any, and throws where it does not hold. `./dev fuzz` looks for
// bytes that break it; corpora_test.cpp goes over those that were worth keeping.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace least::fuzz {

/// Bytes of a client: however they are cut, the same requests come of them, within their bounds, and what was taken
/// for a request is one when it is written down strictly.
void guard(std::string_view bytes);

/// JSON: what is read is echoed as a request that is read as the same; what is refused is refused in a document.
void request(std::string_view bytes);

/// A field `Accept`: of what is offered the best is taken, whatever else is offered.
void accept(std::string_view bytes);

/// Numbers and a text: JSON, CBOR and lines say the same of them.
void forms(std::string_view bytes);

/// A formula: printed from its tape and read again it has the same value, its faults lie within it, its MathML is
/// well-formed.
void formula(std::string_view bytes);

/// Choices: which values of a good request are replaced, and by what. What is read runs, for a short time, as the
/// service runs it: the answer is whole, and a refusal says why.
void values(std::string_view bytes);
/// The status of that answer; 0 where the build leaves out what it takes.
int status_of_values(std::string_view bytes);

struct Target {
  std::string_view name;  ///< and that of its folder in tests/fuzz/corpus
  void (*check)(std::string_view bytes);
};
inline constexpr Target targets[] = {{"guard", guard}, {"request", request}, {"accept", accept},
                                     {"forms", forms}, {"formula", formula}, {"values", values}};

inline void ensure(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error(what);
}

}  // namespace least::fuzz
