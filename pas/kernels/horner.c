/* Values of a polynomial of degree n in x, y, z at many points, by Horner's rule over z inside y inside x.

   Coefficients stand in the order in which the rule meets them.  A block of points at once keeps the loops over
   points innermost, where the compiler makes vector instructions of them; every operation is rounded on its own. */

#include <stddef.h>
#include <stdlib.h>

#include "kernel.h"

#define BLOCK 64

FAST
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

/* Values (count, points) of `count` polynomials on the piece that each point (a row of three) is in.

   The tables of a piece stand one behind the other where `starts` says, with degrees of its own. */
int pas_mixed(ptrdiff_t pieces, ptrdiff_t count, const ptrdiff_t *degrees, const ptrdiff_t *starts, const double *tables,
              ptrdiff_t points, const double *places, const ptrdiff_t *piece_of, double *values)
{
    ptrdiff_t *ends = calloc(pieces + 1, sizeof(ptrdiff_t)), *order = malloc((points + 1) * sizeof(ptrdiff_t));
    double x[BLOCK], y[BLOCK], z[BLOCK], found[BLOCK];
    const int good = ends && order;
    for (ptrdiff_t p = 0; good && p < points; p++) ends[piece_of[p] + 1]++;
    for (ptrdiff_t i = 0; good && i < pieces; i++) ends[i + 1] += ends[i];
    for (ptrdiff_t p = 0; good && p < points; p++) order[ends[piece_of[p]]++] = p;
    for (ptrdiff_t i = 0, start = 0; good && i < pieces; start = ends[i++])
        for (; start < ends[i]; start += BLOCK) {
            const ptrdiff_t size = ends[i] - start < BLOCK ? ends[i] - start : BLOCK, *rows = order + start;
            const double *table = tables + starts[i];
            for (ptrdiff_t r = 0; r < size; r++) {
                x[r] = places[3 * rows[r]];
                y[r] = places[3 * rows[r] + 1];
                z[r] = places[3 * rows[r] + 2];
            }
            for (ptrdiff_t k = 0; k < count; k++) {
                const ptrdiff_t n = degrees[i * count + k];
                pas_horner((int)n, size, table, x, y, z, found);
                table += (n + 1) * (n + 2) * (n + 3) / 6;
                for (ptrdiff_t r = 0; r < size; r++) values[k * points + rows[r]] = found[r];
            }
        }
    free(ends);
    free(order);
    return good ? 0 : -1;
}
