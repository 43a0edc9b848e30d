#include "core/run/diagnostics/zero_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace least {

using interval::Enclosure;
using interval::RateEnclosure;

namespace {

constexpr double round_off = std::numeric_limits<double>::epsilon();

/// polynomial returns the coefficients of the polynomial through values at u = −1, −½, 0, ½, 1.
std::array<double, 5> polynomial(const std::array<double, 5>& f) {
  const double even = (f[4] + f[0]) / 2 - f[2], even_half = (f[3] + f[1]) / 2 - f[2];
  const double odd = (f[4] - f[0]) / 2, odd_half = (f[3] - f[1]) / 2;
  const double c4 = 4 * (even - 4 * even_half) / 3, c3 = 4 * (odd - 2 * odd_half) / 3;
  return {f[2], odd - c3, even - c4, c3, c4};
}

/// halved returns the same polynomial in w, where u = middle + w/2.
std::array<double, 5> halved(std::array<double, 5> c, double middle) {
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t i = 4; i-- > k;) c[i] += middle * c[i + 1];
  double scale = 1;
  for (double& one : c) one *= std::exchange(scale, scale / 2);
  return c;
}

}  // namespace

ZeroSearch::ZeroSearch(const Measures& measures, const ObserveAt& observe_at, int effort)
    : measures_(measures), observe_at_(observe_at), effort_(effort) {
  for (std::size_t i = 0; i < measures.reads.size(); ++i)
    if (measures.reads[i]) read_.push_back(i);
  observed_.resize(measures.reads.size());
  points_.resize(measures.reads.size());
  boxes_.resize(measures.reads.size());
}

ZeroSearch::Piece ZeroSearch::sampled(double from, double to, Bits open) {
  Piece piece{from, to, open, true, std::vector<Curve>(read_.size())};
  if (read_.empty()) return piece;
  for (std::size_t k = 0; k < 5; ++k) {
    const double t = k == 0 ? from : k == 4 ? to : from + static_cast<double>(k) * (to - from) / 4;
    piece.known = piece.known && observe_at_(t, observed_.data());
    for (std::size_t i = 0; i < read_.size(); ++i) {
      const double x = observed_[read_[i]];
      piece.curves[i].c[k] = x;
      piece.known = piece.known && std::isfinite(x);
    }
  }
  const double late = 2 * round_off * std::max(std::abs(from), std::abs(to)) / piece.radius();
  for (Curve& curve : piece.curves) {
    double largest = 0;
    for (const double x : curve.c) largest = std::max(largest, std::abs(x));
    curve.c = polynomial(curve.c);
    // The truncation error is smaller than the last terms by about the factor by which they fall.
    const double left_out = std::abs(curve.c[3]) / 10 + std::abs(curve.c[4]) / 2;
    curve.round_off = 4 * round_off * largest + late * std::abs(curve.c[1]);
    curve.error = left_out + curve.round_off;
    curve.rate_error = 8 * left_out / piece.radius();
  }
  return piece;
}

bool ZeroSearch::exact(const Piece& piece) {
  return std::ranges::all_of(piece.curves, [](const Curve& curve) { return curve.error <= 4 * curve.round_off; });
}

bool ZeroSearch::gains_by_states(const Piece& piece) {
  return !piece.known || std::ranges::any_of(piece.curves, [](const Curve& curve) {
    double extent = 0;
    for (std::size_t k = 1; k < 5; ++k) extent += std::abs(curve.c[k]);
    return curve.error > std::max(extent / 8, 4 * curve.round_off);
  });
}

ZeroSearch::Piece ZeroSearch::half(const Piece& whole, bool second, Bits open, bool anew) {
  const double from = second ? whole.middle() : whole.from, to = second ? whole.to : whole.middle();
  Piece piece{from, to, open, whole.known, whole.curves};
  if (whole.known)
    for (Curve& curve : piece.curves) curve.c = halved(curve.c, second ? 0.5 : -0.5);
  if (!anew && !gains_by_states(piece)) return piece;
  Piece fresh = sampled(from, to, open);
  // On short pieces: if half the length does not reduce the truncation error much, it is round-off of the states
  // themselves.
  if (whole.known && fresh.known && fresh.radius() < vague_)
    for (std::size_t i = 0; i < fresh.curves.size(); ++i) {
      Curve& curve = fresh.curves[i];
      const double left_out = curve.error - curve.round_off, before = whole.curves[i].error - whole.curves[i].round_off;
      if (4 * left_out > before) curve.round_off = curve.error;
    }
  return fresh;
}

void ZeroSearch::enclose(const Piece& piece) {
  for (std::size_t i = 0; i < read_.size(); ++i) {
    const Curve& curve = piece.curves[i];
    const auto& c = curve.c;
    const double odd = std::abs(c[1]) + std::abs(c[3]) + curve.error;
    const double turn =
        (std::abs(c[2]) * 2 + std::abs(c[3]) * 3 + std::abs(c[4]) * 4) / piece.radius() + curve.rate_error;
    const double slope = c[1] / piece.radius();
    boxes_[read_[i]] = {{c[0] - odd + std::min(c[2], 0.0) + std::min(c[4], 0.0),
                         c[0] + odd + std::max(c[2], 0.0) + std::max(c[4], 0.0)},
                        {slope - turn, slope + turn}};
  }
  measures_.enclose(boxes_.data(), {{piece.from, piece.to}, 1.0}, whole_.data());
}

void ZeroSearch::enclose_middle(const Piece& piece) {
  for (std::size_t i = 0; i < read_.size(); ++i) {
    const Curve& curve = piece.curves[i];
    points_[read_[i]] = {curve.c[0] - curve.error, curve.c[0] + curve.error};
  }
  measures_.enclose(points_.data(), piece.middle(), middle_.data());
}

void ZeroSearch::add(const Piece& piece, std::size_t which, Kind kind, double noise) {
  auto& all = brackets_[which];
  const bool same = !all.empty() && all.back().kind == kind && all.back().to == piece.from;
  if (same && (kind == Kind::round_off || kind == Kind::edge)) {  // both are one bracket
    all.back().to = piece.to;
    all.back().noise = std::max(all.back().noise, noise);
  } else {
    all.push_back({piece.from, piece.to, kind, noise});
  }
}

ZeroSearch::Bits ZeroSearch::examine(const Piece& piece) {
  needs_states_ = false;
  if (!piece.known) return piece.open;
  enclose(piece);
  Bits open = 0;
  for (std::size_t i = 0; i < measures_.size(); ++i)
    if (whole_[i].value.defined != interval::Defined::nowhere && whole_[i].value.contains(0)) open |= Bits{1} << i;
  open &= piece.open;
  if (open == 0) return 0;
  enclose_middle(piece);
  const bool at_round_off = exact(piece);
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    const Bits bit = Bits{1} << i;
    if (!(open & bit) || !whole_[i].value.everywhere()) continue;
    const Enclosure& middle = middle_[i];
    const double change = whole_[i].rate.magnitude() * piece.radius();
    const double late = whole_[i].rate.magnitude() * round_off * std::max(std::abs(piece.from), std::abs(piece.to));
    const bool hidden = change <= middle.width();
    scale_[i] = std::max(scale_[i], middle.magnitude());
    if (middle.low > change + late || middle.high < -change - late) {  // the mean value theorem
      open &= ~bit;
    } else if ((hidden && at_round_off) || whole_[i].monotone()) {
      add(piece, i, hidden && at_round_off ? Kind::round_off : Kind::monotone, middle.width());
      open &= ~bit;
    } else {
      needs_states_ = needs_states_ || hidden;
    }
  }
  return open;
}

/// leave keeps a piece that cannot be divided any further.
void ZeroSearch::leave(const Piece& piece, Bits open) {
  constexpr double small = 1e-3;
  for (std::size_t i = 0; i < measures_.size(); ++i) {
    if (!(open >> i & 1)) continue;
    const Enclosure& value = whole_[i].value;
    add(piece, i, value.everywhere() ? Kind::round_off : Kind::edge);
    if (value.everywhere() && value.width() > small * scale_[i]) wild_.emplace_back(i, piece.from);
  }
}

void ZeroSearch::search(const Piece& piece) {
  const Bits open = examine(piece);
  const bool anew = needs_states_;
  if (open == 0) return;
  if (!piece.known && piece.radius() <= vague_) return;
  if (piece.radius() <= shortest_) return leave(piece, open);
  if (effort_ <= 0) {
    unresolved_ |= open;
    for (std::size_t i = 0; i < measures_.size(); ++i)
      if (open >> i & 1) add(piece, i, Kind::open);
    return;
  }
  --effort_;
  search(half(piece, false, open, anew));
  search(half(piece, true, open, anew));
}

void ZeroSearch::find(double from, double to, int pieces) {
  vague_ = (to - from) * 0x1p-10;
  // Four units in the last place of time, and at most as many divisions as a double has digits.
  shortest_ = std::max((to - from) * 0x1p-48, 2 * round_off * std::max(std::abs(from), std::abs(to)));
  const Bits all = static_cast<Bits>((std::uint64_t{1} << measures_.size()) - 1);
  double last = from;
  for (int k = 1; k <= pieces; ++k) {
    const double next = k < pieces ? from + k * (to - from) / pieces : to;
    search(sampled(last, next, all));
    last = next;
  }
  // Brackets as short as time resolves lie where the curves put them, off the states by round-off: they are widened.
  const double moved = 32 * shortest_;
  for (auto& found : brackets_)
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].kind != Kind::round_off && found[k].kind != Kind::edge) continue;
      found[k].from = std::max(found[k].from - moved, k > 0 ? found[k - 1].to : from);
      found[k].to = std::min(found[k].to + moved, k + 1 < found.size() ? found[k + 1].from : to);
    }
  // Next to an end of the domain of an expression no bounds are good.
  constexpr double beside = 1000;
  for (const auto& [which, t] : wild_)
    if (std::ranges::none_of(brackets_[which], [&, time = t](const Bracket& edge) {
          return edge.kind == Kind::edge && std::abs(time - edge.from) <= beside * shortest_;
        }))
      unresolved_ |= Bits{1} << which;
}

bool ZeroSearch::may_find(double from, double to, int pieces) {
  const Bits all = static_cast<Bits>((std::uint64_t{1} << measures_.size()) - 1);
  double last = from;
  for (int k = 1; k <= pieces; ++k) {
    const double next = k < pieces ? from + k * (to - from) / pieces : to;
    if (examine(sampled(last, next, all)) != 0) return true;
    last = next;
  }
  return std::ranges::any_of(brackets_, [](const auto& found) { return !found.empty(); });
}

}  // namespace least
