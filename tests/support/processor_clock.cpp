// In tests linked with this file the time limit of runs counts processor seconds, so that results do not depend on
// other load of the machine.
#include "tests/support/processor_clock.hpp"

namespace {

const runs::ProcessorClock clock_of_all_tests;

}  // namespace
