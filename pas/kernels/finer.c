/* Each triangle of a mesh cut into m^2, for pas/mesh/fine.py. */

#include <stddef.h>

#include "pas.h"

static inline double dot(const double *u, const double *v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* Points on cubics over edges, m - 1 on each: by `shares` (m - 1, 4) of both ends and of the ways along the normals. */
static void on_edges(whole edges, const whole *ends, const double *points, const double *normals, whole inner,
                     const double *shares, double *result)
{
    for (whole e = 0; e < edges; e++) {
        const double *p = points + 3 * ends[2 * e], *q = points + 3 * ends[2 * e + 1];
        const double *n = normals + 3 * ends[2 * e], *k = normals + 3 * ends[2 * e + 1];
        const double way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        const double first = dot(way, n), last = dot(way, k);
        for (whole j = 0; j < inner; j++) {
            const double *s = shares + 4 * j;
            for (int i = 0; i < 3; i++)
                *result++ = s[0] * p[i] + s[1] * q[i] - s[2] * (first * n[i]) + s[3] * (last * k[i]);
        }
    }
}

/* Points inside triangles at barycentric coordinates (inner, 3), with the offsets of the edges blended. */
static void inside(whole count, const whole *triangles, const double *points, const double *normals, whole inner,
                   const double *weights, double *result)
{
    for (whole t = 0; t < count; t++) {
        const double *p[3], *n[3];
        double bow[3][3];
        for (int k = 0; k < 3; k++) {
            p[k] = points + 3 * triangles[3 * t + k];
            n[k] = normals + 3 * triangles[3 * t + k];
        }
        for (int k = 0; k < 3; k++) {
            const int j = (k + 1) % 3;
            const double way[3] = {p[j][0] - p[k][0], p[j][1] - p[k][1], p[j][2] - p[k][2]};
            const double last = dot(way, n[j]), first = dot(way, n[k]);
            for (int i = 0; i < 3; i++) bow[k][i] = last * n[j][i] - first * n[k][i];
        }
        for (whole r = 0; r < inner; r++) {
            const double *w = weights + 3 * r;
            for (int i = 0; i < 3; i++) {
                double place = w[0] * p[0][i] + w[1] * p[1][i] + w[2] * p[2][i];
                for (int k = 0; k < 3; k++) place += 0.5 * (w[k] * w[(k + 1) % 3]) * bow[k][i];
                *result++ = place;
            }
        }
    }
}

/* The points that are new, and all small triangles.  The lattice of a triangle (places) has corners, sides and inner
   points where `corners` (3), `sides` (3, m - 1) and `within` (inner) say; `cut` (parts, 3) are its small triangles.
   `edge_of` (count, 3) is the edge that a side is, from its lower to its higher vertex. */
int pas_finer(whole count, const whole *triangles, whole size, const double *points, const double *normals, whole edges,
              const whole *ends, const whole *edge_of, whole m, const double *shares, whole inner,
              const double *weights, const whole *corners, const whole *sides, const whole *within, whole parts,
              const whole *cut, whole *grid, double *fresh, whole *result)
{
    const whole on_side = m - 1;
    on_edges(edges, ends, points, normals, on_side, shares, fresh);
    inside(count, triangles, points, normals, inner, weights, fresh + 3 * edges * on_side);
    for (whole t = 0; t < count; t++) {
        const whole *v = triangles + 3 * t;
        for (int k = 0; k < 3; k++) {
            const whole start = size + edge_of[3 * t + k] * on_side;
            grid[corners[k]] = v[k];
            for (whole j = 0; j < on_side; j++)
                grid[sides[k * on_side + j]] = start + (v[k] < v[(k + 1) % 3] ? j : on_side - 1 - j);
        }
        for (whole r = 0; r < inner; r++) grid[within[r]] = size + edges * on_side + t * inner + r;
        for (whole i = 0; i < 3 * parts; i++) *result++ = grid[cut[i]];
    }
    return 0;
}
