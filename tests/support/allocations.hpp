// Counts what this thread allocates, through the global operator new (allocations.cpp, in the law tests).
#pragma once

#include <cstddef>

namespace counting {
std::size_t allocations();
}
