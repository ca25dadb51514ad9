/* What compiled kernels share: vector instructions where the machine has them. */

#ifndef PAS_KERNEL_H
#define PAS_KERNEL_H

#include <stdlib.h> /* says which C library it is */

#include "pas.h"

/* Functions that are compiled for several processors, of which one is chosen when the library is loaded. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__)
#define FAST __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define FAST
#endif

/* Rows (m) of so many from `start` on, as a block of that width; the last stands for those that are missing. */
static inline void gather(whole width, whole count, whole start, whole m, const double *rows, double *block)
{
    for (whole r = 0; r < width; r++) {
        const double *row = rows + (start + r < count ? start + r : count - 1) * m;
        for (whole i = 0; i < m; i++) block[i * width + r] = row[i];
    }
}

#endif
