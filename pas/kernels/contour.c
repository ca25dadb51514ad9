/* Marching tetrahedra, for pas/mesh/contour.py. */

#include <stddef.h>
#include <string.h>

#include "pas.h"

#define CLASSES 8

/* How many corners are inside: one (class 0), three (1), or two of six pairs; -1 where the sides do not differ. */
static int class_of(const whole *t, const char *negative)
{
    static const int pairs[16] = {-1, 0, 0, 2, 0, 3, 5, 1, 0, 4, 6, 1, 7, 1, 1, -1}; /* by bits of corners */
    return pairs[!!negative[t[0]] | !!negative[t[1]] << 1 | !!negative[t[2]] << 2 | !!negative[t[3]] << 3];
}

static whole key_of(whole a, whole b, whole size) { return a < b ? a * size + b : b * size + a; }

/* The crossed edges at the corners of triangles (`keys`), three for each tetrahedron with one corner alone, then twice
   three for each with two and two; `number` of triangles.  `number` may be at most twice `count`. */
int pas_crossings(whole count, const whole *tetrahedra, whole size, const char *negative, whole *keys, whole *number)
{
    static const int others[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    static const int both[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
    whole times[CLASSES] = {0}, start[CLASSES];
    for (whole i = 0; i < count; i++) {
        const int kind = class_of(tetrahedra + 4 * i, negative);
        if (kind >= 0) times[kind]++;
    }
    *number = 0;
    for (int kind = 0; kind < CLASSES; kind++) {
        start[kind] = 3 * *number;
        *number += (kind < 2 ? 1 : 2) * times[kind];
    }
    for (whole i = 0; i < count; i++) {
        const whole *t = tetrahedra + 4 * i;
        const int kind = class_of(t, negative);
        if (kind < 0) continue;
        whole *to = keys + start[kind];
        start[kind] += 3;
        if (kind < 2) {
            int apex = 0;
            while ((negative[t[apex]] != 0) != (kind == 0)) apex++;
            for (int k = 0; k < 3; k++) to[k] = key_of(t[apex], t[others[apex][k]], size);
            continue;
        }
        const int *p = both[kind - 2];
        const whole ring[4] = {key_of(t[p[0]], t[p[2]], size), key_of(t[p[0]], t[p[3]], size),
                               key_of(t[p[1]], t[p[3]], size), key_of(t[p[1]], t[p[2]], size)};
        for (int k = 0; k < 3; k++) {
            to[k] = ring[k];
            to[3 * times[kind] + k] = ring[k ? k + 1 : 0];
        }
    }
    return 0;
}

/* Turn triangles so that their normals point to the positive side; corner number i is somewhere on edge number i. */
int pas_oriented(whole count, whole *triangles, const double *points, const whole *edges, const double *nodes,
                 const char *negative)
{
    for (whole i = 0; i < count; i++) {
        whole *t = triangles + 3 * i;
        double rise[3] = {0}, u[3], v[3];
        for (int k = 0; k < 3; k++) {
            const whole a = edges[2 * t[k]], b = edges[2 * t[k] + 1];
            for (int x = 0; x < 3; x++) {
                const double way = nodes[3 * b + x] - nodes[3 * a + x];
                rise[x] += negative[a] ? way : -way;
            }
        }
        for (int x = 0; x < 3; x++) {
            u[x] = points[3 * t[1] + x] - points[3 * t[0] + x];
            v[x] = points[3 * t[2] + x] - points[3 * t[0] + x];
        }
        const double side = (u[1] * v[2] - u[2] * v[1]) * rise[0] + (u[2] * v[0] - u[0] * v[2]) * rise[1] +
                            (u[0] * v[1] - u[1] * v[0]) * rise[2];
        if (side < 0) {
            const whole other = t[1];
            t[1] = t[2];
            t[2] = other;
        }
    }
    return 0;
}
