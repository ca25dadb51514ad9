/* Bernstein forms of a polynomial and its gradient on many triangles, for pas/certify/triangle_forms.py, and the faces
   through which rays leave a region, and the cells of points, for pas/surface/local_surface.py.

   Compiled together with pas/algebra/horner.c.  A function that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "kernel.h"

#define BLOCK 64

/* Rows of a matrix (rows, columns) times blocks of numbers (columns, BLOCK). */
FAST
static void times(whole rows, whole columns, const double *matrix, const double *numbers, double *results)
{
    for (whole i = 0; i < rows; i++) {
        double sums[BLOCK];
        for (int r = 0; r < BLOCK; r++) sums[r] = matrix[i * columns] * numbers[r];
        for (whole j = 1; j < columns; j++) {
            const double factor = matrix[i * columns + j];
            const double *row = numbers + j * BLOCK;
            for (int r = 0; r < BLOCK; r++) sums[r] += factor * row[r];
        }
        for (int r = 0; r < BLOCK; r++) results[i * BLOCK + r] = sums[r];
    }
}

FAST
static void extend(whole rows, const double *numbers, double *low, double *high)
{
    for (int r = 0; r < BLOCK; r++) low[r] = high[r] = numbers[r];
    for (whole i = 1; i < rows; i++)
        for (int r = 0; r < BLOCK; r++) {
            const double v = numbers[i * BLOCK + r];
            low[r] = v < low[r] ? v : low[r];
            high[r] = v > high[r] ? v : high[r];
        }
}

/* The values (m, BLOCK) at the lattice points with barycentric coordinates (m, 3). */
FAST
static void at_lattice(whole n, whole m, const double *lattice, const double *coefficients, const double *block,
                       double *values)
{
    for (whole k = 0; k < m; k++) {
        double place[3][BLOCK];
        const double *w = lattice + 3 * k;
        for (int i = 0; i < 3; i++)
            for (int r = 0; r < BLOCK; r++)
                place[i][r] = w[0] * block[i * BLOCK + r] + w[1] * block[(3 + i) * BLOCK + r] +
                              w[2] * block[(6 + i) * BLOCK + r];
        pas_horner(n, BLOCK, coefficients, place[0], place[1], place[2], values + k * BLOCK);
    }
}

/* The least and the largest B-coefficients of triangles (count, 9), of a higher degree where there is a matrix for it. */
int pas_ranges(whole n, whole m, const double *lattice, const double *inverse, whole higher, const double *raising,
               const double *coefficients, whole count, const double *corners, double *low, double *high)
{
    double block[9 * BLOCK], least[BLOCK], most[BLOCK];
    double *room = malloc((2 * m + higher) * BLOCK * sizeof(double));
    if (!room) return -1;
    for (whole start = 0; start < count; start += BLOCK) {
        double *values = room, *forms = room + m * BLOCK, *raised = forms + m * BLOCK;
        gather(BLOCK, count, start, 9, corners, block);
        at_lattice(n, m, lattice, coefficients, block, values);
        times(m, m, inverse, values, forms);
        if (higher) times(higher, m, raising, forms, raised);
        extend(higher ? higher : m, higher ? raised : forms, least, most);
        for (whole r = 0; r < BLOCK && start + r < count; r++) {
            low[start + r] = least[r];
            high[start + r] = most[r];
        }
    }
    free(room);
    return 0;
}

FAST
static void along(whole m, const double *forms, const double *normals, double *least, double *sizes)
{
    for (whole k = 0; k < m; k++) {
        const double *x = forms + k * BLOCK, *y = x + m * BLOCK, *z = y + m * BLOCK;
        for (int r = 0; r < BLOCK; r++) {
            const double slope = normals[r] * x[r] + normals[BLOCK + r] * y[r] + normals[2 * BLOCK + r] * z[r];
            const double size = x[r] * x[r] + y[r] * y[r] + z[r] * z[r];
            least[r] = k == 0 || slope < least[r] ? slope : least[r];
            sizes[r] = k == 0 || size > sizes[r] ? size : sizes[r];
        }
    }
}

/* The least B-coefficient of the derivative along each triangle's normal (count, 3), and the largest squared size of
   those of the gradient, whose three polynomials stand one behind the other. */
int pas_slopes(whole n, whole m, const double *lattice, const double *inverse, const double *coefficients, whole count,
               const double *corners, const double *normals, double *least, double *sizes)
{
    const whole stride = (n + 1) * (n + 2) * (n + 3) / 6;
    double block[9 * BLOCK], unit[3 * BLOCK], some[BLOCK], large[BLOCK];
    double *room = malloc(4 * m * BLOCK * sizeof(double));
    if (!room) return -1;
    for (whole start = 0; start < count; start += BLOCK) {
        gather(BLOCK, count, start, 9, corners, block);
        gather(BLOCK, count, start, 3, normals, unit);
        for (int i = 0; i < 3; i++) {
            at_lattice(n, m, lattice, coefficients + i * stride, block, room);
            times(m, m, inverse, room, room + (i + 1) * m * BLOCK);
        }
        along(m, room + m * BLOCK, unit, some, large);
        for (whole r = 0; r < BLOCK && start + r < count; r++) {
            least[start + r] = some[r];
            sizes[start + r] = large[r];
        }
    }
    free(room);
    return 0;
}

/* The multiples of points at which their rays leave the region, and the piece of the face through which: that with the
   largest of the least weights, the first of several.  For `stride` and `step` see `pas_mixed`. */
FAST
int pas_leaving(whole faces, const double *weights, const whole *piece_of, whole count, const double *points, whole stride,
                whole step, double *multiples, whole *pieces)
{
    for (whole start = 0; start < count; start += BLOCK) {
        const whole size = count - start < BLOCK ? count - start : BLOCK;
        double x[BLOCK] = {0}, y[BLOCK] = {0}, z[BLOCK] = {0}, best[BLOCK], total[BLOCK];
        whole chosen[BLOCK] = {0};
        for (whole r = 0; r < size; r++) {
            const double *point = points + stride * (start + r);
            x[r] = point[0];
            y[r] = point[step];
            z[r] = point[2 * step];
        }
        for (whole f = 0; f < faces; f++) {
            const double *w = weights + 9 * f;
            for (int r = 0; r < BLOCK; r++) {
                const double a = w[0] * x[r] + w[1] * y[r] + w[2] * z[r], b = w[3] * x[r] + w[4] * y[r] + w[5] * z[r];
                const double c = w[6] * x[r] + w[7] * y[r] + w[8] * z[r], lower = a < b ? a : b;
                const double least = lower < c ? lower : c, sum = a + b + c;
                const int better = f == 0 || least > best[r];
                best[r] = better ? least : best[r];
                total[r] = better ? sum : total[r];
                chosen[r] = better ? f : chosen[r];
            }
        }
        for (whole r = 0; r < size; r++) {
            multiples[start + r] = 1.0 / total[r];
            pieces[start + r] = piece_of[chosen[r]];
        }
    }
    return 0;
}

/* The least of a point's barycentric coordinates in a cell. */
static inline double depth_in(const double *map, double x, double y, double z)
{
    double least = INFINITY;
    for (int k = 0; k < 16; k += 4) {
        const double depth = map[k] * x + map[k + 1] * y + map[k + 2] * z + map[k + 3];
        least = depth < least ? depth : least;
    }
    return least;
}

/* The piece of the cell in which a point is deepest, of all cells or those of one piece; -1 where it is outside all by
   more than a tolerance. */
static whole piece_at(whole cells, const double *maps, const whole *piece_of, whole only, const double *p, double tolerance)
{
    double best = -INFINITY;
    whole found = -1;
    for (whole c = 0; c < cells; c++) {
        if (only >= 0 && piece_of[c] != only) continue;
        const double least = depth_in(maps + 16 * c, p[0], p[1], p[2]);
        if (least > best) {
            best = least;
            found = piece_of[c];
        }
    }
    return best >= -tolerance ? found : -1;
}

/* Whether a point is behind walls, whose planes are 1 on them. */
static int behind(whole walls, const double *planes, const double *p, double tolerance)
{
    for (whole w = 0; w < walls; w++, planes += 3)
        if (!(planes[0] * p[0] + planes[1] * p[1] + planes[2] * p[2] <= 1 + tolerance)) return 0;
    return 1;
}

/* The pieces of points (3, count), -1 outside: `sizes` says how many cells there are, and how many planes through 0 (-1
   where pieces are those of cells).  The signs at these tell the piece by `table`, but for signs that there are by
   rounding alone; then the point must be behind the walls of the piece, which begin at `starts`, or, where there are
   none of them, in one of its cells. */
FAST
int pas_located(const whole *sizes, const double *maps, const whole *piece_of, const double *normals, const whole *table,
                const whole *starts, const double *walls, whole count, const double *points, double tolerance,
                whole *pieces)
{
    const whole cells = sizes[0], planes = sizes[1];
    const double *x = points, *y = x + count, *z = y + count;
    for (whole start = 0; start < count; start += BLOCK) {
        const whole size = count - start < BLOCK ? count - start : BLOCK;
        whole codes[BLOCK] = {0};
        for (whole k = 0; k < planes; k++) {
            const double *n = normals + 3 * k;
            for (whole r = 0; r < size; r++) {
                const double height = n[0] * x[start + r] + n[1] * y[start + r] + n[2] * z[start + r];
                codes[r] |= (whole)(height >= 0) << k;
            }
        }
        for (whole r = 0; r < size; r++) {
            const double p[3] = {x[start + r], y[start + r], z[start + r]};
            whole piece = planes < 0 ? -1 : table[codes[r]];
            if (!(fabs(p[0]) < INFINITY && fabs(p[1]) < INFINITY && fabs(p[2]) < INFINITY)) piece = -1;
            else if (planes < 0) piece = piece_at(cells, maps, piece_of, -1, p, tolerance);
            else {
                if (piece < 0) piece = piece_at(cells, maps, piece_of, -1, p, INFINITY);
                const whole own = starts[piece + 1] - starts[piece];
                if (own ? !behind(own, walls + 3 * starts[piece], p, tolerance)
                        : piece_at(cells, maps, piece_of, piece, p, tolerance) < 0)
                    piece = -1;
            }
            pieces[start + r] = piece;
        }
    }
    return 0;
}
