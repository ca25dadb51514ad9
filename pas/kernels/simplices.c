/* Simplices with B-coefficients of polynomials: halved, for pas/bernstein/simplices.py, and judged by whether the
   polynomial rises along one direction, for pas/certify/critical_points.py.  A function that finds no memory returns
   -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define BLOCK 16

/* What is known of a polynomial on a simplex; the numbers are those of pas.bernstein.search.Fate. */
enum { RISES, OPEN, LOST, SURE };

/* A direction (d, BLOCK) by the products of edges (d, d, BLOCK) with one another and with it: by cofactors, its sizes
   summing to 1. */
FAST
static void direction(int d, double (*gram)[3][BLOCK], double (*mean)[BLOCK], double (*u)[BLOCK])
{
    for (int r = 0; r < BLOCK; r++) {
        double g[3][3] = {{0}}, c[3] = {0}, m[3] = {0}, trace = 0;
        for (int i = 0; i < d; i++) trace += gram[i][i][r];
        for (int i = 0; i < d; i++) {
            m[i] = mean[i][r];
            for (int j = 0; j < d; j++) g[i][j] = gram[i][j][r] / trace;
        }
        if (d == 1) c[0] = m[0];
        if (d == 2) {
            c[0] = g[1][1] * m[0] - g[0][1] * m[1];
            c[1] = g[0][0] * m[1] - g[0][1] * m[0];
        }
        if (d == 3) {
            const double xx = g[1][1] * g[2][2] - g[1][2] * g[1][2], xy = g[0][2] * g[1][2] - g[0][1] * g[2][2];
            const double xz = g[0][1] * g[1][2] - g[0][2] * g[1][1], yy = g[0][0] * g[2][2] - g[0][2] * g[0][2];
            const double yz = g[0][1] * g[0][2] - g[0][0] * g[1][2], zz = g[0][0] * g[1][1] - g[0][1] * g[0][1];
            c[0] = xx * m[0] + xy * m[1] + xz * m[2];
            c[1] = xy * m[0] + yy * m[1] + yz * m[2];
            c[2] = xz * m[0] + yz * m[1] + zz * m[2];
        }
        double size = fabs(c[0]);
        for (int i = 1; i < d; i++) size += fabs(c[i]);
        for (int i = 0; i < d; i++) u[i][r] = c[i] / size;
    }
}

/* The products of the edges from the first of corners (3 d + 3, BLOCK). */
FAST
static void products(int d, const double *corners, double (*gram)[3][BLOCK])
{
    double way[3][3][BLOCK];
    for (int k = 0; k < d; k++)
        for (int i = 0; i < 3; i++)
            for (int r = 0; r < BLOCK; r++)
                way[k][i][r] = corners[(3 * k + 3 + i) * BLOCK + r] - corners[i * BLOCK + r];
    for (int k = 0; k < d; k++)
        for (int j = 0; j < d; j++)
            for (int r = 0; r < BLOCK; r++)
                gram[k][j][r] = way[k][0][r] * way[j][0][r] + way[k][1][r] * way[j][1][r] + way[k][2][r] * way[j][2][r];
}

/* The mean (d, BLOCK) of the steps between coefficients along edges, or the least product of the steps with `u`. */
FAST
static void steps(int d, whole lower, const whole *up, const double *forms, double (*u)[BLOCK], double (*mean)[BLOCK],
                  double *least)
{
    memset(mean, 0, 3 * BLOCK * sizeof(double));
    for (whole k = 0; k < lower; k++) {
        const double *base = forms + up[(d + 1) * k] * BLOCK;
        double along[BLOCK];
        for (int i = 0; i < d; i++) {
            const double *next = forms + up[(d + 1) * k + i + 1] * BLOCK;
            if (!u)
                for (int r = 0; r < BLOCK; r++) mean[i][r] += next[r] - base[r];
            else if (i == 0)
                for (int r = 0; r < BLOCK; r++) along[r] = (next[r] - base[r]) * u[i][r];
            else
                for (int r = 0; r < BLOCK; r++) along[r] += (next[r] - base[r]) * u[i][r];
        }
        if (u)
            for (int r = 0; r < BLOCK; r++) least[r] = k == 0 || along[r] < least[r] ? along[r] : least[r];
    }
    for (int i = 0; i < d; i++)
        for (int r = 0; r < BLOCK; r++) mean[i][r] /= (double)lower;
}

FAST
static void span(whole m, const double *forms, double *low, double *high)
{
    for (whole k = 0; k < m; k++)
        for (int r = 0; r < BLOCK; r++) {
            const double value = forms[k * BLOCK + r];
            low[r] = k == 0 || value < low[r] ? value : low[r];
            high[r] = k == 0 || value > high[r] ? value : high[r];
        }
}

/* Of simplices (count) with forms (m), off by `bound`, and corners (d + 1, 3) whether the function rises along a
   direction, is nothing but rounding, has coefficients of one sign, or is open. */
int pas_judged(whole count, whole m, whole d, whole lower, const whole *up, const double *forms, const double *corners,
               double bound, double roundings, whole *states)
{
    double *block = malloc((m + 3 * d + 3) * BLOCK * sizeof(double));
    double gram[3][3][BLOCK], mean[3][BLOCK], unused[3][BLOCK], u[3][BLOCK], least[BLOCK], low[BLOCK], high[BLOCK];
    if (!block) return -1;
    for (whole start = 0; start < count; start += BLOCK) {
        gather(BLOCK, count, start, m, forms, block);
        span(m, block, low, high);
        if (d) {
            gather(BLOCK, count, start, 3 * d + 3, corners, block + m * BLOCK);
            products((int)d, block + m * BLOCK, gram);
            steps((int)d, lower, up, block, NULL, mean, least);
            direction((int)d, gram, mean, u);
            steps((int)d, lower, up, block, u, unused, least);
        }
        for (whole r = 0; r < BLOCK && start + r < count; r++) {
            const double largest = -low[r] > high[r] ? -low[r] : high[r];
            const double away = low[r] > -high[r] ? low[r] : -high[r];
            const int rises = d && least[r] > 2 * bound + roundings * largest;
            states[start + r] = rises ? RISES : away - bound > 0 ? SURE : largest <= bound ? LOST : OPEN;
        }
    }
    free(block);
    return 0;
}

/* Both halves, one behind the other, of simplices with forms (m) and corners (d + 1, 3), cut in the middle of their
   longest of some edges (edges, 2), by means (means) of coefficients. */
int pas_halved(whole count, whole m, whole d, whole edges, const whole *pairs, whole means, const whole *halves,
               const whole *taken, const double *forms, const double *corners, double *new_forms, double *new_corners)
{
    double *table = malloc(means * sizeof(double));
    if (!table) return -1;
    for (whole t = 0; t < count; t++) {
        const double *from = corners + 3 * (d + 1) * t;
        whole edge = 0;
        double longest = -1;
        for (whole e = 0; e < edges; e++) {
            const double *a = from + 3 * pairs[2 * e], *b = from + 3 * pairs[2 * e + 1];
            const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2], length = x * x + y * y + z * z;
            if (length > longest) {
                longest = length;
                edge = e;
            }
        }
        memcpy(table, forms + m * t, m * sizeof(double));
        for (whole k = m; k < means; k++) {
            const whole *half = halves + 2 * (means * edge + k);
            table[k] = (table[half[0]] + table[half[1]]) / 2;
        }
        for (int side = 0; side < 2; side++) {
            const whole *own = taken + m * (2 * edge + side);
            double *to = new_corners + 3 * (d + 1) * (2 * t + side), *form = new_forms + m * (2 * t + side);
            for (whole j = 0; j < m; j++) form[j] = table[own[j]];
            memcpy(to, from, 3 * (d + 1) * sizeof(double));
            for (int i = 0; i < 3; i++)
                to[3 * pairs[2 * edge + 1 - side] + i] =
                    (from[3 * pairs[2 * edge] + i] + from[3 * pairs[2 * edge + 1] + i]) / 2;
        }
    }
    free(table);
    return 0;
}
