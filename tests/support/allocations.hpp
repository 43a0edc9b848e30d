// allocations() counts the allocations of this thread, through the global operator new and malloc (allocations.cpp, in
// the law tests).
#pragma once

#include <cstddef>

namespace counting {
std::size_t allocations();
}
