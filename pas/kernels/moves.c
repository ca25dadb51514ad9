/* Where the points of a mesh are moved to make its triangles better, for pas/mesh/graded.py.  A function that finds
   no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "pas.h"
#include "vectors.h"

/* What rims turn at vertices, over the length of their edges, which are those from `inner` on; 0 where they are fixed.
   Each vertex of a rim begins one edge and ends one. */
static void turned(whole edges, const whole *every, whole inner, whole size, const double *points, const char *fixed,
                   double *turn, double *bends)
{
    for (whole v = 0; v < size; v++) bends[v] = turn[3 * v] = turn[3 * v + 1] = turn[3 * v + 2] = 0.0;
    for (int second = 0; second < 2; second++)
        for (whole e = inner; e < edges; e++) {
            const whole a = every[2 * e], b = every[2 * e + 1];
            double way[3];
            minus(points + 3 * b, points + 3 * a, way);
            const double length = sqrt(dot(way, way));
            for (int i = 0; i < 3; i++)
                turn[3 * (second ? b : a) + i] = second ? turn[3 * b + i] - way[i] / length : way[i] / length;
            bends[second ? b : a] = second ? bends[b] + length : length;
        }
    for (whole v = 0; v < size; v++) {
        if (bends[v] == 0.0) continue;
        const double span = bends[v], *t = turn + 3 * v;
        bends[v] = fixed[v] ? 0.0 : 2 * sqrt(dot(t, t)) / span;
    }
}

/* How long edges should be: as the curvatures `bends` let them be, a chord as far from its arc as `eight`, over 8, says,
   no longer than `longest`, nor than `bent` radii, of rims as well. */
int pas_wanted_sizes(whole edges, const whole *every, whole inner, whole size, const double *points, const double *bends,
              const char *fixed, double eight, double least_bend, double bent, double least_bent, double grade,
              double *sizes)
{
    double *room = malloc((4 * size + 1) * sizeof(double)), *rims = room + 3 * size;
    if (!room) return -1;
    turned(edges, every, inner, size, points, fixed, room, rims);
    for (whole v = 0; v < size; v++) {
        const double bend = bends[v] < least_bend ? least_bend : bends[v];
        const double more = bends[v] < rims[v] ? rims[v] : bends[v];
        const double longest = bent / (more < least_bent ? least_bent : more);
        const double chord = sqrt(eight / bend);
        sizes[v] = chord < longest ? chord : longest;
    }
    free(room);
    return pas_grown(edges, every, size, points, grade, sizes);
}

/* Points moved towards the mean of their triangles' centres, those of the rim along it, in tangent planes; `fixed` stay.
   Edges should be as long as `pas_wanted_sizes` says. */
int pas_moved(whole count, const whole *triangles, whole edges, const whole *every, whole inner, whole size,
              const double *points, const double *normals, const double *bends, const char *fixed, double eight,
              double least_bend, double bent, double least_bent, double grade, double *moved)
{
    double *sizes = malloc((size + 1) * sizeof(double));
    whole *before = malloc((2 * size + 1) * sizeof(whole)), *after = before + size;
    int state = sizes && before ? 0 : -1;
    for (whole v = 0; state == 0 && v < size; v++) before[v] = after[v] = -1;
    if (state == 0)
        state = pas_wanted_sizes(edges, every, inner, size, points, bends, fixed, eight, least_bend, bent, least_bent, grade,
                          sizes);
    if (state == 0) state = pas_centred(count, triangles, size, points, sizes, moved);
    for (whole e = inner; state == 0 && e < edges; e++) {
        after[every[2 * e]] = every[2 * e + 1];
        before[every[2 * e + 1]] = every[2 * e];
    }
    for (whole v = 0; state == 0 && v < size; v++) {
        double *move = moved + 3 * v;
        const double *p = points + 3 * v, *normal = normals + 3 * v, off = move[0] * normal[0] + move[1] * normal[1] + move[2] * normal[2];
        for (int i = 0; i < 3; i++) {
            double way = move[i] - off * normal[i];
            if (after[v] >= 0 && before[v] >= 0) way = (points[3 * before[v] + i] + points[3 * after[v] + i]) / 4 - p[i] / 2;
            move[i] = p[i] + (fixed[v] ? 0.0 : way);
        }
    }
    free(sizes);
    free(before);
    return state;
}

/* The centres of chosen triangles (count), then the middles of chosen edges (edges), (count + edges, 3). */
int pas_middles(whole count, const whole *chosen, const whole *triangles, whole edges, const whole *marked,
                const whole *ends, const double *points, double *middles)
{
    for (whole k = 0; k < count; k++) {
        const whole *v = triangles + 3 * chosen[k];
        const double *a = points + 3 * v[0], *b = points + 3 * v[1], *c = points + 3 * v[2];
        for (int i = 0; i < 3; i++) middles[3 * k + i] = (a[i] + b[i] + c[i]) / 3;
    }
    for (whole k = 0; k < edges; k++) {
        const double *p = points + 3 * ends[2 * marked[k]], *q = points + 3 * ends[2 * marked[k] + 1];
        for (int i = 0; i < 3; i++) middles[3 * (count + k) + i] = (p[i] + q[i]) / 2;
    }
    return 0;
}

static inline double square_of(const double *p, const double *q)
{
    const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    return x * x + y * y + z * z;
}

/* How many triangles have an angle below 30 degrees: by the cosine opposite to the shortest side, squared. */
int pas_slender(whole count, const whole *triangles, const double *points, whole *number)
{
    *number = 0;
    for (whole t = 0; t < count; t++) {
        const double *a = points + 3 * triangles[3 * t], *b = points + 3 * triangles[3 * t + 1];
        const double *c = points + 3 * triangles[3 * t + 2];
        double s[3] = {square_of(a, b), square_of(b, c), square_of(c, a)};
        for (int k = 0; k < 3; k++) { /* in order */
            const int i = k == 1 ? 1 : 0;
            const double low = s[i] < s[i + 1] ? s[i] : s[i + 1], high = s[i] < s[i + 1] ? s[i + 1] : s[i];
            s[i] = low;
            s[i + 1] = high;
        }
        const double across = s[1] + s[2] - s[0];
        *number += across * across > 3 * s[1] * s[2];
    }
    return 0;
}
