/* Where vertices leave the triangles about them least slender, for pas/mesh/places.py. */

#include <math.h>
#include <stddef.h>

#include "pas.h"
#include "vectors.h"

typedef struct {
    whole count;
    const whole *first, *second;
    const double *points, *normal, *weights, *floors;
    double aim;
} Ring;

/* The best place so far, and what it leaves too slender. */
typedef struct {
    double place[3], left;
} Best;

static inline double larger(double a, double b) { return a > b ? a : b; }

static inline double lack(const Ring *ring, whole i, double sine)
{
    const double lacking = larger(ring->aim - sine, 0.0);
    return ring->weights[i] * lacking * lacking;
}

/* The sine of the smallest angle of a triangle, and the vector across it. */
static double sine_of(const double *a, const double *b, const double *c, double *across)
{
    double u[3], v[3], w[3];
    minus(b, a, u);
    minus(c, a, v);
    minus(c, b, w);
    cross(u, v, across);
    const double x = dot(u, u), y = dot(v, v), z = dot(w, w);
    return sqrt(dot(across, across) / larger(larger(larger(x * y, y * z), z * x), 1e-300));
}

static void take(const Ring *ring, const double *place, Best *best)
{
    double left = 0.0;
    for (whole i = 0; i < ring->count; i++) {
        const double *b = ring->points + 3 * ring->first[i], *c = ring->points + 3 * ring->second[i];
        double across[3], sine = sine_of(place, b, c, across);
        if (!(dot(across, ring->normal) > 0)) sine = -1.0; /* it is turned over */
        if (!(sine >= ring->floors[i])) return;
        left += lack(ring, i, sine);
    }
    if (!(left < best->left)) return;
    best->left = left;
    for (int k = 0; k < 3; k++) best->place[k] = place[k];
}

/* A way without its part along the normal. */
static void levelled(const double *normal, double *way)
{
    const double along = dot(way, normal);
    for (int k = 0; k < 3; k++) way[k] -= along * normal[k];
}

/* `limits`: the aim, the sine below which triangles do not weigh more, the height of equilateral triangles, and how
   long the ways about the best place are; `starts` has one more number than there are vertices. */
int pas_better_places(whole count, const whole *vertices, const whole *starts, const whole *first, const whole *second,
                      const double *points, const double *normals, const double *before, const double *weights,
                      const double *floors, const double *limits, whole steps, const double *shares, whole turns, const double *turned,
                      double *places, double *was, double *left)
{
    for (whole v = 0; v < count; v++) {
        const whole start = starts[v], size = starts[v + 1] - start;
        const double *here = points + 3 * vertices[v], *normal = normals + 3 * vertices[v];
        const Ring ring = {size, first + start, second + start, points, normal, weights + start, floors + start, limits[0]};
        double apexes[3] = {0}, sharpest[3] = {0}, ends[3] = {0}, way[3][3], along[3], aside[3], weight = 0, sum = 0;
        Best best = {{here[0], here[1], here[2]}, 0.0};
        for (whole i = 0; i < size; i++) {
            const double *a = points + 3 * ring.first[i], *b = points + 3 * ring.second[i], sine = before[start + i];
            double edge[3], up[3], sharp = 1 / larger(sine, limits[1]);
            sharp = sharp * sharp;
            sharp = sharp * sharp;
            minus(b, a, edge);
            cross(normal, edge, up);
            for (int k = 0; k < 3; k++) {
                const double both = a[k] + b[k], apex = both / 2 + limits[2] * up[k];
                apexes[k] += apex;
                sharpest[k] += apex * sharp;
                ends[k] += both;
            }
            weight += sharp;
            sum += sqrt(dot(edge, edge));
            best.left += lack(&ring, i, sine);
        }
        was[v] = best.left;
        for (int k = 0; k < 3; k++) {
            way[0][k] = sharpest[k] / weight - here[k];
            way[1][k] = apexes[k] / (double)size - here[k];
            way[2][k] = (ends[k] / (double)size + here[k]) / 3 - here[k];
        }
        for (int w = 0; w < 3; w++) {
            levelled(normal, way[w]);
            for (whole s = 0; s < steps; s++) {
                double place[3];
                for (int k = 0; k < 3; k++) place[k] = here[k] + shares[s] * way[w][k];
                take(&ring, place, &best);
            }
        }
        const double middle[3] = {best.place[0], best.place[1], best.place[2]};
        minus(points + 3 * ring.second[0], points + 3 * ring.first[0], along);
        levelled(normal, along);
        const double reach = limits[3] * sum / (double)size / larger(sqrt(dot(along, along)), 1e-300);
        for (int k = 0; k < 3; k++) along[k] *= reach;
        cross(normal, along, aside);
        for (whole t = 0; t < turns; t++) {
            double place[3];
            for (int k = 0; k < 3; k++) place[k] = middle[k] + (turned[2 * t] * along[k] + turned[2 * t + 1] * aside[k]);
            take(&ring, place, &best);
        }
        for (int k = 0; k < 3; k++) places[3 * v + k] = best.place[k];
        left[v] = best.left;
    }
    return 0;
}

/* The sines of the smallest angles of triangles. */
int pas_sines(whole count, const whole *triangles, const double *points, double *found)
{
    for (whole t = 0; t < count; t++) {
        const double *a = points + 3 * triangles[3 * t], *b = points + 3 * triangles[3 * t + 1];
        const double *c = points + 3 * triangles[3 * t + 2];
        double across[3];
        found[t] = sine_of(a, b, c, across);
    }
    return 0;
}
