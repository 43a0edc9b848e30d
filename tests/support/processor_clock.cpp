// Tests linked with this file give runs processor seconds: what a run finds before its limit of seconds does not depend
// on what else the machine does.
#include "tests/support/processor_clock.hpp"

namespace {

const runs::ProcessorClock clock_of_all_tests;

}  // namespace
