#pragma once

// One body for several instruction sets: the loops are element by element and contraction is off, so all give
// the same bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define MIEN_WIDE_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define MIEN_WIDE_VECTORS
#endif
