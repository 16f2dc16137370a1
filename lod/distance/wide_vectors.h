#pragma once

/// Before a function: compiles its loops for wider vectors, too, and takes those where the processor has them. The same
/// instructions on wider vectors give the same numbers: there is no fused multiply-add (see LodestoneTarget).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define LODESTONE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define LODESTONE_WIDE_VECTORS
#endif
