/* The edge table of triangles, and what follows from it alone: fans, and meshes without what is gone. */

#include <stdlib.h>
#include <string.h>

#include "halfedge.h"

enum { ALONE = -1, CROWDED = -2 };

static inline whole end_in(const whole *corners, whole h) { return corners[next(h)]; }

static inline whole lower_in(const whole *corners, whole h)
{
    const whole a = corners[h], b = end_in(corners, h);
    return a < b ? a : b;
}

/* Where the half edges of each lower vertex begin in `order` (3 count), as `first` (size + 1). */
static void sorted(whole count, const whole *corners, whole size, whole *first, whole *order)
{
    memset(first, 0, (size + 2) * sizeof(whole));
    for (whole h = 0; h < 3 * count; h++) first[lower_in(corners, h) + 2]++;
    for (whole v = 1; v <= size + 1; v++) first[v] += first[v - 1];
    for (whole h = 0; h < 3 * count; h++) order[first[lower_in(corners, h) + 1]++] = h;
}

/* Make two half edges of one edge twins, unless the first has one already or leads the same way. */
static void paired(const whole *corners, whole *twins, whole g, whole h)
{
    if (twins[g] == ALONE && corners[g] == end_in(corners, h)) {
        twins[g] = h;
        twins[h] = g;
        return;
    }
    if (twins[g] >= 0) twins[twins[g]] = CROWDED;
    twins[g] = twins[h] = CROWDED;
}

/* The twins (3 count) of half edges: -1 where there is none, -2 where an edge has more than two triangles, or two that
   are not turned alike.  Vertices are numbers below `size`. */
int pas_twins(whole count, const whole *corners, whole size, whole *twins)
{
    whole *room = malloc((3 * count + 3 * size + 2) * sizeof(whole));
    if (!room) return -1;
    whole *first = room, *order = first + size + 2, *seen = order + 3 * count, *open = seen + size;
    sorted(count, corners, size, first, order);
    for (whole v = 0; v < size; v++) seen[v] = -1;
    for (whole v = 0; v < size; v++)
        for (whole i = first[v]; i < first[v + 1]; i++) {
            const whole h = order[i], a = corners[h], b = end_in(corners, h), high = a < b ? b : a;
            twins[h] = a == b ? CROWDED : ALONE;
            if (seen[high] == v)
                paired(corners, twins, open[high], h);
            else {
                seen[high] = v;
                open[high] = h;
            }
        }
    free(room);
    return 0;
}

/* How many fans of triangles there are about each vertex (size); edges without a twin end them. */
int pas_fans(whole count, const whole *corners, whole size, const whole *twins, whole *fans)
{
    char *seen = calloc(3 * count + 1, 1);
    if (!seen) return -1;
    memset(fans, 0, size * sizeof(whole));
    for (whole start = 0; start < 3 * count; start++) {
        if (seen[start]) continue;
        whole h = start;
        while (twins[h] >= 0 && next(twins[h]) != start) h = next(twins[h]); /* clockwise, to where the fan begins */
        fans[corners[h]]++;
        while (h >= 0 && !seen[h]) {
            seen[h] = 1;
            h = twins[previous(h)];
        }
    }
    free(seen);
    return 0;
}

/* The half edges with which those around vertices begin, and the kinds of vertices, of which some are pinned. */
int pas_mesh_classify(Mesh *m)
{
    for (whole v = 0; v < m->vertices; v++) m->outgoing[v] = -1;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        whole *out = m->outgoing + m->corners[h];
        if (*out < 0 || m->twins[h] < 0 || m->twins[*out] >= 0) *out = h;
    }
    for (whole h = 0; h < 3 * m->triangles; h++) /* others are inside faces */
        if (on_curve(m, h)) {
            const whole a = m->corners[h], b = end_of(m, h);
            m->kinds[a] = kind_of(m, a);
            m->kinds[b] = kind_of(m, b);
        }
    return 0;
}

/* New numbers of the vertices, wedges and triangles that are left, -1 of others; how many these are into `left`. */
static void numbers_left(Mesh *m, whole *vertex, whole *wedge, whole *triangle, whole *left)
{
    for (whole v = 0; v < m->vertices; v++) vertex[v] = m->outgoing[v] >= 0 ? left[0]++ : -1;
    for (whole w = 0; w < m->wedges; w++) wedge[w] = -1;
    for (whole t = 0; t < m->triangles; t++) {
        triangle[t] = m->corners[3 * t] >= 0 ? left[2]++ : -1;
        for (int k = 0; triangle[t] >= 0 && k < 3; k++) wedge[m->wedge_of[3 * t + k]] = 0;
    }
    for (whole w = 0; w < m->wedges; w++)
        if (wedge[w] == 0) wedge[w] = left[1]++;
}

static void pack_triangles(Mesh *m, const whole *vertex, const whole *wedge, const whole *triangle)
{
    for (whole t = 0; t < m->triangles; t++) {
        if (triangle[t] < 0) continue;
        m->label_of[triangle[t]] = m->label_of[t];
        for (int k = 0; k < 3; k++) {
            const whole from = 3 * t + k, to = 3 * triangle[t] + k, other = m->twins[from];
            m->corners[to] = vertex[m->corners[from]];
            m->wedge_of[to] = wedge[m->wedge_of[from]];
            m->twins[to] = other < 0 ? other : 3 * triangle[other / 3] + other % 3;
        }
    }
}

static void pack_vertices(Mesh *m, const whole *vertex, const whole *wedge, const whole *triangle)
{
    for (whole w = 0; w < m->wedges; w++) {
        const whole to = wedge[w];
        if (to < 0) continue;
        memmove(m->normals + 3 * to, m->normals + 3 * w, 3 * sizeof(double));
        m->bends[to] = m->bends[w];
        m->vertex_of[to] = vertex[m->vertex_of[w]];
        m->face_of[to] = m->face_of[w];
    }
    for (whole v = 0; v < m->vertices; v++) {
        const whole to = vertex[v], out = m->outgoing[v];
        if (to < 0) continue;
        memmove(m->points + 3 * to, m->points + 3 * v, 3 * sizeof(double));
        m->sizes[to] = m->sizes[v];
        m->caps[to] = m->caps[v];
        m->kinds[to] = m->kinds[v];
        m->fresh[to] = m->fresh[v];
        m->outgoing[to] = 3 * triangle[out / 3] + out % 3;
        m->marks[to] = 0;
    }
    m->stamp = 0;
}

/* Leave out what is gone; what is left keeps its order. */
int pas_mesh_pack(Mesh *m)
{
    whole *vertex = malloc((m->vertices + m->wedges + m->triangles + 1) * sizeof(whole));
    if (!vertex) return -1;
    whole *wedge = vertex + m->vertices, *triangle = wedge + m->wedges, left[3] = {0, 0, 0};
    numbers_left(m, vertex, wedge, triangle, left);
    pack_triangles(m, vertex, wedge, triangle);
    pack_vertices(m, vertex, wedge, triangle);
    m->vertices = left[0];
    m->wedges = left[1];
    m->triangles = left[2];
    free(vertex);
    return 0;
}

/* Put a number among the ascending ones of a row that ends with -1, unless it is there or the row is full. */
static void inserted(whole *row, whole width, whole number)
{
    whole at = 0;
    while (at < width && row[at] >= 0 && row[at] < number) at++;
    if (at == width || row[at] == number || row[width - 1] >= 0) return;
    memmove(row + at + 1, row + at, (width - 1 - at) * sizeof(whole));
    row[at] = number;
}

/* The labels about chosen vertices (count, width), ascending, then -1. */
int pas_mesh_labels_about(const Mesh *m, whole count, const whole *chosen, whole width, whole *labels)
{
    for (whole i = 0; i < width * count; i++) labels[i] = -1;
    for (whole i = 0; i < count; i++) AROUND(m, chosen[i], h) inserted(labels + width * i, width, m->label_of[h / 3]);
    return 0;
}

/* The centres of triangles in given rows, then the middles of given half edges. */
int pas_mesh_middles(const Mesh *m, whole count, const whole *rows, whole some, const whole *halves, double *middles)
{
    for (whole i = 0; i < count; i++) {
        const whole *v = m->corners + 3 * rows[i];
        const double *a = m->points + 3 * v[0], *b = m->points + 3 * v[1], *c = m->points + 3 * v[2];
        for (int x = 0; x < 3; x++) *middles++ = (a[x] + b[x] + c[x]) / 3;
    }
    for (whole i = 0; i < some; i++) {
        const double *a = m->points + 3 * m->corners[halves[i]], *b = m->points + 3 * end_of(m, halves[i]);
        for (int x = 0; x < 3; x++) *middles++ = (a[x] + b[x]) / 2;
    }
    return 0;
}
