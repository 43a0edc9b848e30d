#include "core/run/diagnostics/events.hpp"

#include <cmath>
#include <iterator>

#include "core/run/root.hpp"

namespace least {

void Events::locate(const ProblemTable& problem, const RunState& left, const RunState& right,
                    const std::function<RunState(double t)>& at) {
  SectionValues was{}, is{}, between{};
  problem.sections(left, was.data());
  problem.sections(right, is.data());
  for (std::size_t i = 0; i < problem.traits.sections; ++i) {
    if ((was[i] < 0) == (is[i] < 0)) continue;
    const auto value = [&](double part) {
      problem.sections(at(left.t + part), between.data());
      return between[i];
    };
    const double ahead = root(value, 0, right.t - left.t);
    const RunState x = at(left.t + ahead);
    if (std::isnan(between[i])) continue;  // the computation is to end, and the state there is not known
    add(i, is[i] > 0, x.t, x[0]);
  }
}

void Events::add(std::size_t section, bool upwards, double t, double first) {
  if (section == 0) note(zeros_, t);
  if (section == 0 && upwards) {
    constexpr std::ptrdiff_t most = 4096;
    if (rises_++ > 0) cycles_.push_back({t - last_rise_, amplitude_});
    if (std::ssize(cycles_) > most) cycles_.erase(cycles_.begin(), cycles_.begin() + most / 2);
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
  if (!room(list.size())) return;
  make_room(list, list.size() + 1, held_);
  list.push_back(t);
}

bool Events::converged(double Cycle::*number) const {
  constexpr double tolerance = 1e-3;
  const std::size_t last = cycles_.size() - 1, third = cycles_.size() / 3;
  const double now = cycles_[last].*number, most = tolerance * std::abs(now);
  for (std::size_t i = last - third; i < last; ++i)
    if (!(std::abs(cycles_[i].*number - now) <= most)) return false;
  // The limit of a geometric sequence through three of them (Aitken): slow growth changes little from cycle to cycle.
  const double change = now - cycles_[last - third].*number;
  const double before = cycles_[last - third].*number - cycles_[last - 2 * third].*number;
  return change == 0 || std::abs(change * change / (before - change)) <= most;
}

Report Events::cycle() const {
  const bool whole = !cycles_.empty();
  Report converging{"converged", std::monostate{}};
  if (cycles_.size() >= 3) converging.value = converged(&Cycle::period) && converged(&Cycle::amplitude);
  Report report = numbers("cycle", {{"period", whole ? cycles_.back().period : unknown},
                                    {"amplitude", whole ? cycles_.back().amplitude : unknown},
                                    {"cycles", rises_ > 0 ? static_cast<double>(rises_ - 1) : 0}});
  insert(report, 3, std::move(converging));
  return report;
}

}  // namespace least
