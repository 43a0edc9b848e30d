#include "core/ensemble/block.hpp"

#include <algorithm>
#include <cmath>

namespace least {
namespace {

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from, std::size_t count) {
  to.insert(to.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

Moments Moments::of(const std::vector<double>& values) {
  Moments all;
  double origin = 0, sum = 0;  // relative to the first value, so that close values have an accurate mean
  for (const double x : values) {
    if (!std::isfinite(x)) continue;
    if (all.count++ == 0) origin = x;
    sum += x - origin;
    all.minimum = std::min(all.minimum, x);
    all.maximum = std::max(all.maximum, x);
  }
  if (all.count == 0) return all;
  all.mean = origin + sum / static_cast<double>(all.count);
  for (const double x : values)
    if (std::isfinite(x)) all.squares += (x - all.mean) * (x - all.mean);
  return all;
}

void Moments::add(const Moments& more) {
  if (more.count == 0) return;
  if (count == 0) {
    *this = more;
    return;
  }
  const auto a = static_cast<double>(count), b = static_cast<double>(more.count);
  const double apart = more.mean - mean;
  mean += apart * (b / (a + b));
  squares += more.squares + apart * apart * (a * b / (a + b));
  count += more.count;
  minimum = std::min(minimum, more.minimum);
  maximum = std::max(maximum, more.maximum);
}

double Moments::variance() const {
  return count > 1 ? squares / static_cast<double>(count - 1) : std::numeric_limits<double>::quiet_NaN();
}

void Histogram::count(const HistogramAsked& asked, double value) {
  if (!std::isfinite(value)) return;
  if (value < asked.low) {
    ++below;
  } else if (!(value < asked.high)) {
    ++above;
  } else {
    const double part = (value - asked.low) / (asked.high - asked.low) * static_cast<double>(asked.bins);
    ++counts[static_cast<std::size_t>(std::min(std::floor(part), static_cast<double>(asked.bins - 1)))];
  }
}

void Histogram::add(const Histogram& more) {
  counts.resize(std::max(counts.size(), more.counts.size()));
  for (std::size_t i = 0; i < more.counts.size(); ++i) counts[i] += more.counts[i];
  below += more.below;
  above += more.above;
}

void SectionPoints::make_room(std::size_t points, std::size_t columns, Held& held) {
  least::make_room(member, points, held);
  least::make_room(crossing, points, held);
  least::make_room(t, points, held);
  least::make_room(values, points * columns, held);
}

void SectionPoints::append(const SectionPoints& more, std::size_t most, std::size_t columns, Held& held) {
  const std::size_t count = std::min(more.t.size(), most - std::min(most, t.size()));
  make_room(t.size() + count, columns, held);
  least::append(member, more.member, count);
  least::append(crossing, more.crossing, count);
  least::append(t, more.t, count);
  least::append(values, more.values, count * columns);
}

void Trajectories::append(const Trajectories& more, Held& held) {
  make_room(member, member.size() + more.member.size(), held);
  make_room(rows, rows.size() + more.rows.size(), held);
  make_room(values, values.size() + more.values.size(), held);
  least::append(member, more.member, more.member.size());
  least::append(rows, more.rows, more.rows.size());
  least::append(values, more.values, more.values.size());
}

void Trajectories::open(std::int64_t first, std::size_t members, std::size_t numbers, Held& held) {
  make_room(member, members, held);
  make_room(rows, members, held);
  make_room(values, members * numbers, held);
  for (std::size_t m = 0; m < members; ++m) member.push_back(first + static_cast<std::int64_t>(m));
  rows.assign(members, 0);
  values.resize(members * numbers);
}

void Trajectories::add(std::size_t place, const std::vector<double>& row) {
  const std::size_t room = values.size() / member.size();
  std::ranges::copy(row, &values[place * room + static_cast<std::size_t>(rows[place]++) * row.size()]);
}

void Trajectories::close(std::size_t columns) {
  if (member.empty()) return;
  const std::size_t room = values.size() / member.size();
  std::size_t end = 0;
  for (std::size_t m = 0; m < member.size(); ++m) {
    const std::size_t count = static_cast<std::size_t>(rows[m]) * columns;
    if (end < m * room)
      std::copy_n(values.begin() + std::ptrdiff_t(m * room), count, values.begin() + std::ptrdiff_t(end));
    end += count;
  }
  values.resize(end);
}

void SectionPoints::cut(std::size_t most, std::size_t columns) {
  if (t.size() <= most) return;
  member.resize(most);
  crossing.resize(most);
  t.resize(most);
  values.resize(most * columns);
}

void Harvest::add(const Harvest& more, std::size_t most, Held& held) {
  const SectionPoints& points = more.section;
  const std::size_t taken = std::min(points.t.size(), most - std::min(most, section.t.size()));
  make_room(final_member, final_member.size() + more.final_member.size(), held);
  make_room(final, final.size() + more.final.size(), held);
  if (taken > 0) section.make_room(section.t.size() + taken, points.values.size() / points.t.size(), held);
  trajectories.append(more.trajectories, held);
  for (std::size_t i = 0; i < ended.size(); ++i) ended[i] += more.ended[i];
  columns.resize(std::max(columns.size(), more.columns.size()));
  for (std::size_t i = 0; i < more.columns.size(); ++i) columns[i].add(more.columns[i]);
  histograms.resize(std::max(histograms.size(), more.histograms.size()));
  for (std::size_t i = 0; i < more.histograms.size(); ++i) histograms[i].add(more.histograms[i]);
  append(final_member, more.final_member, more.final_member.size());
  append(final, more.final, more.final.size());
  truncated = truncated || more.truncated || section.t.size() + more.section.t.size() > most;
  if (!more.section.t.empty())
    section.append(more.section, most, more.section.values.size() / more.section.t.size(), held);
  if (unresolved == 0) first_unresolved = more.first_unresolved;
  unresolved += more.unresolved;
  cost.steps += more.cost.steps;
  cost.force_evaluations += more.cost.force_evaluations;
  cost.iterations += more.cost.iterations;
}

}  // namespace least
