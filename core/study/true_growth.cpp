#include "core/study/true_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace least {
namespace {

/// Sizes records, at each time, the largest |x_i| so far. Rows are t and the variables.
class Sizes final : public RowSink {
 public:
  Sizes(std::size_t variables, std::vector<double>& times, std::vector<double>& sizes)
      : width_(1 + variables), times_(times), sizes_(sizes) {}

  bool append(std::span<const double> rows) override {
    for (; !rows.empty(); rows = rows.subspan(width_)) {
      double size = sizes_.empty() ? 0 : sizes_.back();
      for (std::size_t i = 1; i < width_; ++i)
        if (std::isfinite(rows[i])) size = std::max(size, std::abs(rows[i]));
      times_.push_back(rows[0]);
      sizes_.push_back(size);
    }
    return true;
  }

 private:
  std::size_t width_;
  std::vector<double>&times_, &sizes_;
};

/// accurate_scheme returns the index of an adaptive scheme that applies to the scene.
std::optional<std::size_t> accurate_scheme(const Mechanics& mechanics) {
  const auto& fitting = mechanics.card().schemes;
  for (const char* id : {"taylor", "dormand_prince_5"})
    for (const std::size_t scheme : fitting)
      if (mechanics.schemes()[scheme].id == id) return scheme;
  return std::nullopt;
}

}  // namespace

TrueGrowth::TrueGrowth(const Request& scene, std::size_t variables, const std::atomic<bool>& cancelled)
    : request_(scene), cancelled_(cancelled), known_until_(scene.scene->start) {
  constexpr std::int64_t samples = 20'000, step_limit = 200'000;
  request_.columns.clear();
  for (std::size_t i = 0; i <= variables; ++i) request_.columns.push_back(i);
  request_.diagnostics.clear();
  request_.record = {Record::Mode::samples, samples, {}};
  request_.until_steps = false;
  request_.limits.steps = step_limit;
  request_.control = false;
  request_.probe = true;
  const auto scheme = accurate_scheme(*scene.scene->mechanics);
  goes_on_ = scheme.has_value();
  if (!scheme) return;
  request_.scheme = *scheme;
  request_.settings.clear();
  for (const auto& setting : scene.scene->mechanics->schemes()[*scheme].parameters)
    request_.settings.push_back(setting.value);
}

void TrueGrowth::follow(double end) {
  if (!goes_on_ || !(end > known_until_)) return;
  // Runs begin at the start again, each at least twice as long, so that all together cost at most twice the last.
  const double start = request_.scene->start;
  request_.end = std::max(end, start + 2 * (known_until_ - start));
  times_.clear();
  sizes_.clear();
  Sizes seen(request_.columns.size() - 1, times_, sizes_);
  const Solution outcome = request_.scene->mechanics->run(request_, seen, cancelled_);
  goes_on_ = outcome.stop.reason == ReturnCode::completed;
  known_until_ = outcome.t;
}

double TrueGrowth::size(double t) {
  follow(t);
  const auto after = std::ranges::upper_bound(times_, t);
  return after == times_.begin() ? 0 : sizes_[static_cast<std::size_t>(after - times_.begin()) - 1];
}

double TrueGrowth::time_of_growth(double times, double first, double end) {
  const double small = size(first);
  follow(end);
  const auto large = std::ranges::upper_bound(sizes_, times * small);
  return large == sizes_.end() ? end : std::min(end, times_[static_cast<std::size_t>(large - sizes_.begin())]);
}

}  // namespace least
