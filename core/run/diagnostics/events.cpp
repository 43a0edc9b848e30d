#include "core/run/diagnostics/events.hpp"

#include <cmath>

namespace least {

void Events::add(std::size_t section, bool upwards, double t, double first) {
  if (section == 0) note(zeros_, t);
  if (section == 0 && upwards) {
    if (rises_++ > 0) period_ = t - last_rise_;
    last_rise_ = t;
  }
  if (section == 1) amplitude_ = std::abs(first);
  if (section == 2) note(poles_, t);
}

bool Events::room(std::size_t length) {
  full_ = full_ || length >= most_;
  return length < most_;
}

void Events::note(std::vector<double>& list, double t) {
  if (room(list.size())) list.push_back(t);
}

Report Events::cycle() const {
  const bool whole = rises_ > 1;
  return numbers("cycle", {{"period", whole ? period_ : unknown},
                           {"amplitude", whole ? amplitude_ : unknown},
                           {"cycles", rises_ > 0 ? static_cast<double>(rises_ - 1) : 0}});
}

}  // namespace least
