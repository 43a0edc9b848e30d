#include "server/decode/wording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace least::server {
namespace {

constexpr char folded(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Optimal string alignment distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = folded(a[i - 1]) == folded(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) && folded(a[i - 2]) == folded(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

struct Alias {
  std::string_view said, name;
};

// Common names in other programs and books that are no misspellings of ours.
constexpr Alias aliases[] = {
    {"rk4", "runge_kutta_4"},
    {"verlet", "leapfrog"},
    {"stormer_verlet", "leapfrog"},
    {"velocity_verlet", "leapfrog"},
    {"euler", "explicit_euler"},
    {"midpoint", "explicit_midpoint"},
    {"rk45", "dormand_prince_5"},
    {"dopri5", "dormand_prince_5"},
    {"gauss", "contact_gauss"},
    {"ln", "log"},
    {"arcsin", "asin"},
    {"arccos", "acos"},
    {"arctan", "atan"},
    {"dt", "step"},
    {"h", "step"},
};

bool same(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return folded(x) == folded(y); });
}

}  // namespace

std::string shortest(double x) {
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  std::string plain = fmt::format("{}", x);
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::scientific).ptr;
  std::string_view scientific(text, static_cast<std::size_t>(end - text));
  // 1e+03 → 1e3, 1e-07 → 1e-7
  const auto e = scientific.find('e');
  auto digits = scientific.substr(e + 2);
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size() - 1));
  std::string short_one = fmt::format("{}e{}{}", scientific.substr(0, e), scientific[e + 1] == '-' ? "-" : "", digits);
  return short_one.size() < plain.size() ? short_one : plain;
}

std::string interval(const Range& range) {
  return fmt::format("{}{}, {}{}", range.low_open || std::isinf(range.low) ? '(' : '[', shortest(range.low),
                     shortest(range.high), range.high_open || std::isinf(range.high) ? ')' : ']');
}

std::string listed(std::span<const std::string_view> names) {
  std::string list;
  for (const auto name : names) {
    if (name.empty()) continue;  // names that are not offered
    if (!list.empty()) list += ", ";
    list += name;
  }
  return list;
}

std::string_view closest(std::string_view word, std::span<const std::string_view> names) {
  if (word.empty() || word.size() > 64) return {};
  for (const auto& [said, name] : aliases) {
    if (same(word, said) && std::find(names.begin(), names.end(), name) != names.end()) return name;
  }
  std::string_view best;
  std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
  for (const auto name : names) {
    const std::size_t d = distance(word, name);
    if (d < least && d < name.size()) {
      least = d;
      best = name;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> names) {
  const auto name = closest(word, names);
  return name.empty() ? std::string() : fmt::format("; did you mean \"{}\"?", name);
}

}  // namespace least::server
