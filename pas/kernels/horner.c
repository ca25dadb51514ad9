/* Values of a polynomial of degree n in x, y, z at many points, by Horner's rule over z inside y inside x.

   Coefficients stand in the order in which the rule meets them.  A block of points at once keeps the loops over
   points innermost, where the compiler makes vector instructions of them; every operation is rounded on its own. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define BLOCK 32

FAST
static void horner(ptrdiff_t n, const double *c, const double *x, const double *y, const double *z, double *restrict f)
{
    double g[BLOCK] = {0}, h[BLOCK];
    for (ptrdiff_t i = 0; i <= n; i++) {
        for (ptrdiff_t j = 0; j <= i; j++) {
            for (int r = 0; r < BLOCK; r++) h[r] = *c;
            c++;
            for (ptrdiff_t k = 1; k <= j; k++, c++)
                for (int r = 0; r < BLOCK; r++) h[r] = h[r] * z[r] + *c;
            if (j == 0) for (int r = 0; r < BLOCK; r++) g[r] = h[r];
            else for (int r = 0; r < BLOCK; r++) g[r] = g[r] * y[r] + h[r];
        }
        if (i == 0) for (int r = 0; r < BLOCK; r++) f[r] = g[r];
        else for (int r = 0; r < BLOCK; r++) f[r] = f[r] * x[r] + g[r];
    }
}

int pas_horner(ptrdiff_t n, ptrdiff_t points, const double *coefficients,
                const double *x, const double *y, const double *z, double *values)
{
    const ptrdiff_t whole_blocks = points / BLOCK * BLOCK;
    const size_t left = (points - whole_blocks) * sizeof(double);
    double u[BLOCK] = {0}, v[BLOCK] = {0}, w[BLOCK] = {0}, f[BLOCK];
    for (ptrdiff_t start = 0; start < whole_blocks; start += BLOCK)
        horner(n, coefficients, x + start, y + start, z + start, values + start);
    if (!left) return 0;
    memcpy(u, x + whole_blocks, left);
    memcpy(v, y + whole_blocks, left);
    memcpy(w, z + whole_blocks, left);
    horner(n, coefficients, u, v, w, f);
    memcpy(values + whole_blocks, f, left);
    return 0;
}

/* Values (count, points) of `count` polynomials on the piece that each point is in, from the point `first` on to the one
   before `last`.  From a point to the next it is `stride` numbers, and `step` from a coordinate to the next.

   The tables of a piece stand one behind the other where `starts` says, with degrees of its own.  Points of piece -1 have
   values that are none. */
int pas_mixed(ptrdiff_t pieces, ptrdiff_t count, const ptrdiff_t *degrees, const ptrdiff_t *starts, const double *tables,
              ptrdiff_t points, ptrdiff_t first, ptrdiff_t last, const double *places, ptrdiff_t stride, ptrdiff_t step,
              const ptrdiff_t *piece_of, double *values)
{
    ptrdiff_t *ends = calloc(pieces + 1, sizeof(ptrdiff_t)), *order = malloc((last - first + 1) * sizeof(ptrdiff_t));
    double x[BLOCK] = {0}, y[BLOCK] = {0}, z[BLOCK] = {0}, found[BLOCK];
    const int good = ends && order;
    for (ptrdiff_t p = first; good && p < last; p++) {
        if (piece_of[p] >= 0) ends[piece_of[p] + 1]++;
        else
            for (ptrdiff_t k = 0; k < count; k++) values[k * points + p] = NAN;
    }
    for (ptrdiff_t i = 0; good && i < pieces; i++) ends[i + 1] += ends[i];
    for (ptrdiff_t p = first; good && p < last; p++)
        if (piece_of[p] >= 0) order[ends[piece_of[p]]++] = p;
    for (ptrdiff_t i = 0, start = 0; good && i < pieces; start = ends[i++])
        for (; start < ends[i]; start += BLOCK) {
            const ptrdiff_t size = ends[i] - start < BLOCK ? ends[i] - start : BLOCK, *rows = order + start;
            const double *table = tables + starts[i];
            for (ptrdiff_t r = 0; r < size; r++) {
                const double *place = places + stride * rows[r];
                x[r] = place[0];
                y[r] = place[step];
                z[r] = place[2 * step];
            }
            for (ptrdiff_t k = 0; k < count; k++) {
                const ptrdiff_t n = degrees[i * count + k];
                horner(n, table, x, y, z, found);
                table += (n + 1) * (n + 2) * (n + 3) / 6;
                for (ptrdiff_t r = 0; r < size; r++) values[k * points + rows[r]] = found[r];
            }
        }
    free(ends);
    free(order);
    return good ? 0 : -1;
}
