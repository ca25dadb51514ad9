/* Triangles with labels as half edges, whose arrays are those of pas/mesh/halfedges.py.

   Half edge 3 t + k leads from corner k of triangle t to the next corner; its twin is the half edge that leads back, or
   -1 - c on the boundary curve c.  An edge is on a curve if it has no twin, or two labels.  A wedge is a vertex within a
   label: it has a normal and a curvature.  Inside a pass of collapses the corners of triangles that are gone are -1. */

#ifndef PAS_HALFEDGE_H
#define PAS_HALFEDGE_H

#include <math.h>

#include "kernel.h"
#include "vectors.h"

enum { INSIDE, ON_CURVE, CORNER, PINNED }; /* kinds of vertices: corners stay, and others that are given */
enum { BENT, RULED, PLANE };            /* kinds of faces, by label: ruled ones have straight lines with one normal */

struct Mesh {
    whole vertices, triangles, wedges, stamp;
    double fine, coarse;                /* sags allowed: beside ruled faces, and of curves of others, which are cut later */
    whole plain;                        /* whether lengths are compared with `sizes` alone, whatever the faces */
    double *points, *sizes, *caps;      /* of vertices: places (3), how long edges should be, and may be at most */
    double *normals, *bends;            /* of wedges: unit normals (3), and the larger curvatures */
    whole *corners, *twins, *wedge_of;  /* of half edges: the vertex and the wedge where each begins */
    whole *label_of;                    /* of triangles */
    whole *vertex_of, *face_of;         /* of wedges */
    whole *outgoing, *marks;            /* of vertices: the first half edge around each, on the boundary if there is one */
    char *kinds, *fresh;                /* of vertices; those about which something changed are fresh */
    char *faces;                        /* kinds of labels */
};

static inline whole next(whole h) { return h % 3 == 2 ? h - 2 : h + 1; }

static inline whole previous(whole h) { return h % 3 == 0 ? h + 2 : h - 1; }

static inline whole end_of(const Mesh *m, whole h) { return m->corners[next(h)]; }

static inline whole apex_of(const Mesh *m, whole h) { return m->corners[previous(h)]; }

static inline int on_curve(const Mesh *m, whole h)
{
    return m->twins[h] < 0 || m->label_of[h / 3] != m->label_of[m->twins[h] / 3];
}

/* The next half edge that leaves a vertex, counterclockwise; negative after the last. */
static inline whole turned(const Mesh *m, whole h, whole first)
{
    const whole other = m->twins[previous(h)];
    return other == first ? -1 : other;
}

#define AROUND(m, v, h) for (whole h = (m)->outgoing[v], h##_first = h; h >= 0; h = turned(m, h, h##_first))

static inline double distance(const Mesh *m, whole a, whole b)
{
    double way[3];
    minus(m->points + 3 * a, m->points + 3 * b, way);
    return sqrt(dot(way, way));
}

/* A vector across a triangle, twice as long as its area. */
static inline void across(const Mesh *m, whole a, whole b, whole c, double *normal)
{
    double u[3], v[3];
    minus(m->points + 3 * b, m->points + 3 * a, u);
    minus(m->points + 3 * c, m->points + 3 * a, v);
    cross(u, v, normal);
}

/* The cosine between a triangle and the sum of the normals of three wedges. */
static inline double upright(const Mesh *m, whole a, whole b, whole c, whole i, whole j, whole k)
{
    double n[3], sum[3];
    across(m, a, b, c, n);
    for (int x = 0; x < 3; x++) sum[x] = m->normals[3 * i + x] + m->normals[3 * j + x] + m->normals[3 * k + x];
    return dot(n, sum) / sqrt(larger(dot(n, n) * dot(sum, sum), 1e-300));
}

static inline double upright_at(const Mesh *m, whole triangle)
{
    const whole *v = m->corners + 3 * triangle, *w = m->wedge_of + 3 * triangle;
    return upright(m, v[0], v[1], v[2], w[0], w[1], w[2]);
}

/* How far the middle of an edge is from a face, to second order, by the normals of the wedges at its ends. */
static inline double sag(const Mesh *m, whole a, whole b, whole i, whole j)
{
    double along[3], turn[3];
    minus(m->points + 3 * b, m->points + 3 * a, along);
    minus(m->normals + 3 * j, m->normals + 3 * i, turn);
    return fabs(dot(along, turn)) / 8;
}

/* The sine of the smallest angle of a triangle. */
static inline double sine(const Mesh *m, whole a, whole b, whole c)
{
    double n[3];
    across(m, a, b, c, n);
    const double x = distance(m, a, b), y = distance(m, b, c), z = distance(m, c, a);
    return sqrt(dot(n, n)) / larger(larger(x * y, larger(y * z, z * x)), 1e-300);
}

/* The half edge from a to b, or on the boundary that from b to a; negative where there is none. */
static inline whole between(const Mesh *m, whole a, whole b)
{
    AROUND(m, a, h)
    {
        if (end_of(m, h) == b) return h;
        if (apex_of(m, h) == b && m->twins[previous(h)] < 0) return previous(h);
    }
    return -1;
}

/* A vertex is a corner where three labels meet, curves end or cross, or two boundary curves meet. */
static inline char kind_of(const Mesh *m, whole v)
{
    const whole first = m->outgoing[v];
    whole curves = 0, one = m->label_of[first / 3], other = -1, last = first;
    int corner = 0;
    AROUND(m, v, h)
    {
        const whole label = m->label_of[h / 3];
        curves += on_curve(m, h);
        if (label != one && other < 0) other = label;
        corner |= label != one && label != other;
        last = previous(h);
    }
    curves += m->twins[last] < 0;
    corner |= m->twins[last] < 0 && m->twins[last] != m->twins[first];
    if (m->kinds[v] == PINNED) return PINNED;
    return !curves ? INSIDE : corner || curves != 2 ? CORNER : ON_CURVE;
}

#endif
