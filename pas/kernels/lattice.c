/* Tetrahedra cut into eight, and whether functions on them rise along one direction, as in pas/mesh/lattice.py.

   Blocks of tetrahedra at once keep the loops over these innermost.  A function that finds no memory returns -1. */

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define BLOCK 16
#define PARTS 8

/* Blocks of rows (m, BLOCK) from rows (count, m) that begin at `start`; the last stands for those that are missing. */
static void gather(whole count, whole start, whole m, const double *rows, double *block)
{
    for (int r = 0; r < BLOCK; r++) {
        const double *row = rows + (start + r < count ? start + r : count - 1) * m;
        for (whole i = 0; i < m; i++) block[i * BLOCK + r] = row[i];
    }
}

/* All means (number, BLOCK) of two rows before each that `halves` (number, 2) names, from the first `m` on. */
FAST
static void means_of(whole m, whole number, const whole *halves, double *rows)
{
    for (whole k = m; k < number; k++) {
        const double *a = rows + halves[2 * k] * BLOCK, *b = rows + halves[2 * k + 1] * BLOCK;
        double *mean = rows + k * BLOCK;
        for (int r = 0; r < BLOCK; r++) mean[r] = (a[r] + b[r]) / 2;
    }
}

/* The least and greatest of some rows (m, BLOCK) that `taken` (m) names. */
FAST
static void span(whole m, const whole *taken, const double *rows, double *low, double *high)
{
    for (whole j = 0; j < m; j++) {
        const double *row = rows + taken[j] * BLOCK;
        for (int r = 0; r < BLOCK; r++) {
            low[r] = j == 0 || row[r] < low[r] ? row[r] : low[r];
            high[r] = j == 0 || row[r] > high[r] ? row[r] : high[r];
        }
    }
}

/* One of the eighths of a tetrahedron, with corners (4, 4) in halves: numbers (4) and places (12) of its corners. */
static void corners_of(const whole *corners, const size_t *keys, const double *points, size_t *key, double *place)
{
    for (int k = 0; k < 4; k++) {
        key[k] = 0;
        for (int i = 0; i < 3; i++) place[3 * k + i] = 0;
        for (int j = 0; j < 4; j++) {
            key[k] += (size_t)corners[4 * k + j] * keys[j];
            for (int i = 0; i < 3; i++) place[3 * k + i] += (double)corners[4 * k + j] / 2 * points[3 * j + i];
        }
    }
}

/* The eighths (number, m) of tetrahedra (count, m) that may hold zeros: not those whose coefficients all have one sign
   and are larger than `rounding`.  With places (12) of their corners and the numbers of these (4), which are linear. */
int pas_eighths(whole count, whole m, whole means, const whole *halves, const whole *taken, const whole *corners,
                double rounding, const whole *keys, const double *points, const double *forms, whole *new_keys,
                double *new_points, double *new_forms, whole *number)
{
    double *rows = malloc(means * BLOCK * sizeof(double)), low[PARTS][BLOCK], high[PARTS][BLOCK];
    whole found = 0;
    for (whole start = 0; rows && start < count; start += BLOCK) {
        gather(count, start, m, forms, rows);
        means_of(m, means, halves, rows);
        for (int e = 0; e < PARTS; e++) span(m, taken + e * m, rows, low[e], high[e]);
        for (whole r = 0; r < BLOCK && start + r < count; r++)
            for (int e = 0; e < PARTS; e++) {
                if (low[e][r] > rounding || high[e][r] < -rounding) continue;
                const whole t = start + r;
                for (whole j = 0; j < m; j++) new_forms[found * m + j] = rows[taken[e * m + j] * BLOCK + r];
                corners_of(corners + 16 * e, (const size_t *)keys + 4 * t, points + 12 * t,
                           (size_t *)new_keys + 4 * found, new_points + 12 * found);
                found++;
            }
    }
    const int good = rows != NULL;
    *number = found;
    free(rows);
    return good ? 0 : -1;
}

/* Of blocks of forms and of corners (12, BLOCK) the gradients' mean (3, BLOCK), up to a positive factor, the least of
   their products with that, and the largest squared size. */
FAST
static void rising(whole lower, const whole *up, const double *forms, const double *corners, double *mean,
                   double *least, double *size)
{
    double rows[9][BLOCK], side[BLOCK];
    for (int r = 0; r < BLOCK; r++) {
        double e[3][3];
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++) e[k][i] = corners[(3 * k + 3 + i) * BLOCK + r] - corners[i * BLOCK + r];
        for (int k = 0; k < 3; k++) {
            const double *a = e[(k + 1) % 3], *b = e[(k + 2) % 3];
            rows[3 * k][r] = a[1] * b[2] - a[2] * b[1];
            rows[3 * k + 1][r] = a[2] * b[0] - a[0] * b[2];
            rows[3 * k + 2][r] = a[0] * b[1] - a[1] * b[0];
        }
        side[r] = e[0][0] * rows[0][r] + e[0][1] * rows[1][r] + e[0][2] * rows[2][r];
    }
    for (int k = 0; k < 9; k++)
        for (int r = 0; r < BLOCK; r++) rows[k][r] /= side[r];
    memset(mean, 0, 3 * BLOCK * sizeof(double));
    for (int pass = 0; pass < 2; pass++)
        for (whole k = 0; k < lower; k++) {
            const double *base = forms + up[4 * k] * BLOCK, *first = forms + up[4 * k + 1] * BLOCK;
            const double *second = forms + up[4 * k + 2] * BLOCK, *third = forms + up[4 * k + 3] * BLOCK;
            for (int r = 0; r < BLOCK; r++) {
                const double a = first[r] - base[r], b = second[r] - base[r], c = third[r] - base[r];
                const double x = a * rows[0][r] + b * rows[3][r] + c * rows[6][r];
                const double y = a * rows[1][r] + b * rows[4][r] + c * rows[7][r];
                const double z = a * rows[2][r] + b * rows[5][r] + c * rows[8][r];
                if (pass == 0) {
                    mean[r] += x;
                    mean[BLOCK + r] += y;
                    mean[2 * BLOCK + r] += z;
                } else {
                    const double along = x * mean[r] + y * mean[BLOCK + r] + z * mean[2 * BLOCK + r];
                    const double square = x * x + y * y + z * z;
                    least[r] = k == 0 || along < least[r] ? along : least[r];
                    size[r] = k == 0 || square > size[r] ? square : size[r];
                }
            }
            if (pass == 0 && k == lower - 1)
                for (int i = 0; i < 3 * BLOCK; i++) mean[i] /= (double)lower;
        }
}

/* The mean gradients (count, 3) of functions on tetrahedra, up to positive factors, the least products (count) with
   them, and the largest squared sizes (count) of gradients. */
int pas_risings(whole count, whole m, whole lower, const whole *up, const double *forms, const double *points,
                double *means, double *least, double *sizes)
{
    double corners[12 * BLOCK], mean[3 * BLOCK], some[BLOCK], large[BLOCK];
    double *block = malloc(m * BLOCK * sizeof(double));
    if (!block) return -1;
    for (whole start = 0; start < count; start += BLOCK) {
        gather(count, start, m, forms, block);
        gather(count, start, 12, points, corners);
        rising(lower, up, block, corners, mean, some, large);
        for (whole r = 0; r < BLOCK && start + r < count; r++) {
            for (int i = 0; i < 3; i++) means[3 * (start + r) + i] = mean[i * BLOCK + r];
            least[start + r] = some[r];
            sizes[start + r] = large[r];
        }
    }
    free(block);
    return 0;
}
