#include "core/run/tangent_path.hpp"

#include <utility>

namespace least {
namespace {

TangentMotion motion_of(const RunBackend& backend, double tolerance) {
  tape::Tape tape;
  const auto rates = backend.write_equations(tape);
  return {std::move(tape), rates, 1, tolerance};
}

}  // namespace

TangentPath::TangentPath(const RunBackend& backend, double tolerance, double size)
    : backend_(backend),
      components_(backend.motion().traits.components),
      motion_(motion_of(backend, tolerance * std::clamp(size, 1e-30, 1.0))),
      values_(backend.motion().traits.components + backend.found()),
      slopes_(values_.size()) {}

void TangentPath::start(StateView x, const double* u) {
  backend_.values_of(x, u, values_.data(), slopes_.data());  // velocities found by iteration have tangents, too
  motion_.start(values_, slopes_, x.t);
  longest_ = 0;
  plan();
}

}  // namespace least
