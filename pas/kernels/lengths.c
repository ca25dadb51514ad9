/* How long the edges of a mesh of half edges should be, by the curvature, and how long they are over that. */

#include <stdlib.h>
#include <string.h>

#include "halfedge.h"

#define ACROSS 2.0 /* the ratio at least of edges between opposite sides of a face, however short they are */

/* The larger curvature at each wedge, by the turn of the normals along edges, where the field does not say. */
int pas_mesh_bends(Mesh *m)
{
    for (whole w = 0; w < m->wedges; w++) m->bends[w] = 0;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        const whole i = m->wedge_of[h], j = m->wedge_of[next(h)];
        double way[3], turn[3];
        minus(m->points + 3 * end_of(m, h), m->points + 3 * m->corners[h], way);
        minus(m->normals + 3 * j, m->normals + 3 * i, turn);
        const double bend = sqrt(dot(turn, turn) / larger(dot(way, way), 1e-300));
        m->bends[i] = larger(m->bends[i], bend);
        m->bends[j] = larger(m->bends[j], bend);
    }
    return 0;
}

/* Whether a half edge on a curve is the one by which its edge is counted. */
static inline int counted(const Mesh *m, whole h) { return on_curve(m, h) && !(m->twins[h] >= 0 && m->twins[h] < h); }

/* Edges at vertices on curves at most `bent` times as long as the curve's radius, by how it turns there. */
static int sizes_on_curves(Mesh *m, double bent)
{
    double *turn = calloc(4 * m->vertices + 1, sizeof(double)), *span = turn + 3 * m->vertices;
    if (!turn) return -1;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        if (!counted(m, h)) continue;
        const whole a = m->corners[h], b = end_of(m, h);
        const double length = distance(m, a, b);
        double way[3];
        minus(m->points + 3 * b, m->points + 3 * a, way);
        for (int i = 0; i < 3; i++) {
            turn[3 * a + i] += way[i] / larger(length, 1e-300);
            turn[3 * b + i] -= way[i] / larger(length, 1e-300);
        }
        span[a] += length;
        span[b] += length;
    }
    for (whole v = 0; v < m->vertices; v++) {
        if (m->kinds[v] != ON_CURVE) continue;
        const double bend = 2 * sqrt(dot(turn + 3 * v, turn + 3 * v)) / larger(span[v], 1e-300);
        m->sizes[v] = smaller(m->sizes[v], bent / larger(bend, 1e-300));
    }
    free(turn);
    return 0;
}

/* Sizes that grow by at most `grade` over the way along edges, in three rounds at most. */
static int grow(Mesh *m, double grade)
{
    double *ways = malloc((3 * m->triangles + 1) * sizeof(double));
    if (!ways) return -1;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        const whole g = m->twins[h];
        ways[h] = g >= 0 && g < h ? ways[g] : grade * distance(m, m->corners[h], end_of(m, h));
    }
    for (int round = 0, more = 1; more && round < 3; round++) {
        more = 0;
        for (whole h = 0; h < 3 * m->triangles; h++) {
            double *a = m->sizes + m->corners[h], *b = m->sizes + end_of(m, h);
            if (*b + ways[h] < *a) *a = *b + ways[h];
            else if (*a + ways[h] < *b) *b = *a + ways[h];
            else continue;
            more = 1;
        }
    }
    free(ways);
    return 0;
}

/* Sizes for the sag `fine` after a cut into parts, so that they may have a larger sag before on faces that are not ruled;
   at most `bent` times the radius of curvature. */
int pas_mesh_sizes(Mesh *m, double parts, double fine, double longest, double bent, double grade)
{
    const double tolerance = parts * parts * fine;
    m->coarse = tolerance;
    m->fine = fine;
    m->plain = 0;
    for (whole v = 0; v < m->vertices; v++) m->sizes[v] = smaller(longest, parts * m->caps[v]);
    for (whole w = 0; w < m->wedges; w++) {
        const double bend = larger(m->bends[w], 1e-300), length = smaller(sqrt(8 * tolerance / bend), bent / bend);
        double *size = m->sizes + m->vertex_of[w];
        if (m->faces[m->face_of[w]] == BENT && length < *size) *size = length;
    }
    if (sizes_on_curves(m, bent)) return -1;
    return grow(m, grade);
}

/* Sizes that are the mean lengths of the edges at vertices; on curves, of those along these. */
int pas_mesh_mean_sizes(Mesh *m)
{
    m->plain = 1;
    for (whole v = 0; v < m->vertices; v++) {
        double sum = 0, count = 0;
        AROUND(m, v, h)
        {
            if (m->kinds[v] == INSIDE || on_curve(m, h)) {
                sum += distance(m, v, end_of(m, h));
                count++;
            }
            if (m->twins[previous(h)] < 0) {
                sum += distance(m, v, apex_of(m, h));
                count++;
            }
        }
        m->sizes[v] = sum / larger(count, 1);
    }
    return 0;
}

/* How long half edge h is over what it should be: by the sizes at its ends, or between ruled faces by its sag. */
static double ratio(const Mesh *m, whole h)
{
    const whole a = m->corners[h], b = end_of(m, h), g = m->twins[h];
    if (m->plain) return distance(m, a, b) / smaller(m->sizes[a], m->sizes[b]);
    const int ruled = m->faces[m->label_of[h / 3]] != BENT, other = g >= 0 ? m->faces[m->label_of[g / 3]] != BENT : ruled;
    const double tolerance = ruled && other ? m->fine : m->coarse; /* those beside other faces are cut later */
    double result = ruled && other ? 0 : 2 * distance(m, a, b) / (m->sizes[a] + m->sizes[b]);
    if (!ruled && dot(m->normals + 3 * m->wedge_of[h], m->normals + 3 * m->wedge_of[next(h)]) < 0)
        result = larger(result, ACROSS);
    if (ruled) result = larger(result, sqrt(sag(m, a, b, m->wedge_of[h], m->wedge_of[next(h)]) / tolerance));
    if (g >= 0 && other && on_curve(m, h))
        result = larger(result, sqrt(sag(m, a, b, m->wedge_of[next(g)], m->wedge_of[g]) / tolerance));
    return result;
}

/* The ratios (3 T) of all half edges; of twins they are the same. */
int pas_mesh_ratios(const Mesh *m, double *ratios)
{
    for (whole h = 0; h < 3 * m->triangles; h++)
        ratios[h] = m->twins[h] >= 0 && m->twins[h] < h ? ratios[m->twins[h]] : ratio(m, h);
    return 0;
}
