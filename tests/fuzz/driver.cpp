// A target for libFuzzer: LEAST_FUZZ_TARGET names it. The code under test is compiled by g++, which calls the function
// below at every branch; libFuzzer reads counters in a section of this name.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "tests/fuzz/targets.hpp"

namespace {

// A byte for each place in the code, as far as the addresses differ in these bits.
[[gnu::section("__libfuzzer_extra_counters")]] std::array<std::uint8_t, 1 << 16> counters;

}  // namespace

extern "C" {

[[gnu::no_sanitize("all"), gnu::no_sanitize_coverage]] void __sanitizer_cov_trace_pc();  // NOLINT: g++ calls it so
[[gnu::no_sanitize("all"), gnu::no_sanitize_coverage]] void __sanitizer_cov_trace_pc() {
  const auto place = reinterpret_cast<std::uintptr_t>(__builtin_return_address(0));
  ++counters.data()[(place ^ place >> 16) % counters.size()];
}
// Comparisons of floating-point numbers, which libFuzzer does not know.
void __sanitizer_cov_trace_cmpf(float, float);  // NOLINT: as above
void __sanitizer_cov_trace_cmpf(float, float) {}
void __sanitizer_cov_trace_cmpd(double, double);  // NOLINT: as above
void __sanitizer_cov_trace_cmpd(double, double) {}

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);
int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  least::fuzz::LEAST_FUZZ_TARGET(std::string_view(reinterpret_cast<const char*>(bytes), size));
  return 0;
}

}  // extern "C"
