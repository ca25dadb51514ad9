/* Values of a polynomial of degree n in x, y, z at many points, by Horner's rule over z inside y inside x.

   Coefficients stand in the order in which the rule meets them.  A block of points at once keeps the loops over
   points innermost, where the compiler makes vector instructions of them; every operation is rounded on its own. */

#include <stddef.h>

#define BLOCK 64

#if defined(__x86_64__) && defined(__gnu_linux__) && (defined(__GNUC__) && !defined(__clang__))
__attribute__((target_clones("default", "avx2", "avx512f")))
#endif
void pas_horner(int n, ptrdiff_t points, const double *coefficients,
                const double *x, const double *y, const double *z, double *values)
{
    for (ptrdiff_t start = 0; start < points; start += BLOCK) {
        const int size = points - start < BLOCK ? (int)(points - start) : BLOCK;
        double u[BLOCK] = {0}, v[BLOCK] = {0}, w[BLOCK] = {0}, f[BLOCK] = {0}, g[BLOCK] = {0}, h[BLOCK];
        for (int r = 0; r < size; r++) {
            u[r] = x[start + r];
            v[r] = y[start + r];
            w[r] = z[start + r];
        }
        const double *c = coefficients;
        for (int i = 0; i <= n; i++) {
            for (int j = 0; j <= i; j++) {
                for (int r = 0; r < BLOCK; r++) h[r] = *c;
                c++;
                for (int k = 1; k <= j; k++, c++)
                    for (int r = 0; r < BLOCK; r++) h[r] = h[r] * w[r] + *c;
                if (j == 0) for (int r = 0; r < BLOCK; r++) g[r] = h[r];
                else for (int r = 0; r < BLOCK; r++) g[r] = g[r] * v[r] + h[r];
            }
            if (i == 0) for (int r = 0; r < BLOCK; r++) f[r] = g[r];
            else for (int r = 0; r < BLOCK; r++) f[r] = f[r] * u[r] + g[r];
        }
        for (int r = 0; r < size; r++) values[start + r] = f[r];
    }
}
