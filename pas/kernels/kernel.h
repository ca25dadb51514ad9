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

#endif
