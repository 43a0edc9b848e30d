// zeros, cycle, poles: diagnostics made of the zeros of a scene's sections.

#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

class Zeros final : public Diagnostic {
 public:
  Report report(const RunEnd& end) override { return {"zeros", end.events.zeros()}; }
};
class Cycle final : public Diagnostic {
 public:
  Report report(const RunEnd& end) override { return end.events.cycle(); }
};
class Poles final : public Diagnostic {
 public:
  Report report(const RunEnd& end) override { return {"poles", end.events.poles()}; }
};

}  // namespace

std::unique_ptr<Diagnostic> zeros_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Zeros>();
}
std::unique_ptr<Diagnostic> cycle_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Cycle>();
}
std::unique_ptr<Diagnostic> poles_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Poles>();
}

}  // namespace least
