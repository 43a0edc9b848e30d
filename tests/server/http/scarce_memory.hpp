// Threads for which memory runs out, through the global operator new (admission_test.cpp).
#pragma once

namespace least::server::test {

/// allocations_left is the number of allocations that still succeed on this thread; −1: all.
extern thread_local int allocations_left;

}  // namespace least::server::test
