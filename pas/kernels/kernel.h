/* What compiled kernels share: vector instructions where the machine has them, and the functions of horner.c. */

#ifndef PAS_KERNEL_H
#define PAS_KERNEL_H

#include <stddef.h>

#if defined(__x86_64__) && defined(__gnu_linux__) && (defined(__GNUC__) && !defined(__clang__))
#define FAST __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define FAST
#endif

typedef ptrdiff_t whole;

int pas_horner(whole n, whole points, const double *coefficients, const double *x, const double *y, const double *z,
               double *values);
int pas_mixed(whole pieces, whole count, const whole *degrees, const whole *starts, const double *tables, whole points,
              const double *places, whole stride, whole step, const whole *piece_of, double *values);

#endif
