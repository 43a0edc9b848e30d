#include "tests/support/allocations.hpp"

#include <cerrno>
#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t count = 0;
}

std::size_t counting::allocations() { return count; }

#if defined(__SANITIZE_ADDRESS__) || !defined(__GLIBC__)
// With a sanitizer malloc is the sanitizer's own, so that only operator new is counted.
void* operator new(std::size_t size) {
  ++count;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#else
// Everything that allocates ends in these functions, Eigen's allocations too.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void* malloc(std::size_t size) noexcept {
  ++count;
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  ++count;
  *p = __libc_memalign(alignment, size);
  return *p ? 0 : ENOMEM;
}
}
#endif
