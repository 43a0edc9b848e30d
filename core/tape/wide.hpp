// Where the machine has wider registers, they are used: what is computed is the same. Of what a sanitizer watches there
// is one kind only, as it cannot choose when a program begins.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LEAST_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LEAST_WIDE
#endif
