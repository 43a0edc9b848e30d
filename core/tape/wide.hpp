// Attributes that compile functions for wider registers as well, where the machine has them; results are the same.
// Builds with sanitizers compile one version only, as they cannot choose between versions when a program is loaded.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LEAST_WIDE __attribute__((target_clones("avx2", "default")))
#define LEAST_WIDEST __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
/// For functions with much double-double arithmetic, all of which is inlined.
#define LEAST_FUSED __attribute__((target_clones("arch=x86-64-v3", "default"), flatten))
#else
#define LEAST_WIDE
#define LEAST_WIDEST
#define LEAST_FUSED
#endif

// For functions that are written once per width: their callers choose by LEAST_HAS_….
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define LEAST_BY_FOUR [[gnu::target("avx2")]]
#define LEAST_HAS_BY_FOUR __builtin_cpu_supports("avx2")
#define LEAST_BY_EIGHT [[gnu::target("avx2,avx512f,avx512vl,avx512dq")]]
#define LEAST_HAS_BY_EIGHT \
  (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
#else
#define LEAST_BY_FOUR
#define LEAST_HAS_BY_FOUR false
#define LEAST_BY_EIGHT
#define LEAST_HAS_BY_EIGHT false
#endif
