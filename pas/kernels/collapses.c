/* Collapses of short edges of meshes with a boundary, those of pas/mesh/coarsen.py. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"

typedef struct {
    whole size, count, number;
    const whole *triangles, *edges;
    const double *points, *normals, *sizes;
    whole *first, *around, *edge_first, *next_to;
    char *seen;
} Mesh;

static double ratio(const Mesh *m, whole a, whole b)
{
    const double *p = m->points + 3 * a, *q = m->points + 3 * b;
    const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    return 2 * sqrt(x * x + y * y + z * z) / (m->sizes[a] + m->sizes[b]);
}

/* Which triangles, and which other vertices, are around each vertex. */
static int look_around(Mesh *m)
{
    m->first = calloc(m->size + 2, sizeof(whole));
    m->edge_first = calloc(m->size + 2, sizeof(whole));
    m->around = malloc((3 * m->count + 1) * sizeof(whole));
    m->next_to = malloc((2 * m->number + 1) * sizeof(whole));
    m->seen = calloc(m->size + 1, 1);
    if (!m->first || !m->edge_first || !m->around || !m->next_to || !m->seen) return -1;
    for (whole i = 0; i < 3 * m->count; i++) m->first[m->triangles[i] + 1]++;
    for (whole i = 0; i < 2 * m->number; i++) m->edge_first[m->edges[i] + 1]++;
    for (whole v = 0; v < m->size; v++) {
        m->first[v + 1] += m->first[v];
        m->edge_first[v + 1] += m->edge_first[v];
    }
    for (whole i = 0; i < 3 * m->count; i++) m->around[m->first[m->triangles[i]]++] = i / 3;
    for (whole i = 0; i < 2 * m->number; i++) m->next_to[m->edge_first[m->edges[i]]++] = m->edges[i ^ 1];
    for (whole v = m->size; v > 0; v--) {
        m->first[v] = m->first[v - 1];
        m->edge_first[v] = m->edge_first[v - 1];
    }
    m->first[0] = m->edge_first[0] = 0;
    return 0;
}

static whole shared(Mesh *m, whole a, whole b)
{
    whole found = 0;
    for (whole i = m->edge_first[a]; i < m->edge_first[a + 1]; i++) m->seen[m->next_to[i]] = 1;
    for (whole i = m->edge_first[b]; i < m->edge_first[b + 1]; i++) found += m->seen[m->next_to[i]];
    for (whole i = m->edge_first[a]; i < m->edge_first[a + 1]; i++) m->seen[m->next_to[i]] = 0;
    return found;
}

static int sound(Mesh *m, whole removed, whole kept, whole common, double turned, double longer)
{
    const whole triangles = m->first[removed + 1] - m->first[removed];
    if (shared(m, removed, kept) != common) return 0;
    if (triangles == 2 * common - 1 && m->first[kept + 1] - m->first[kept] == triangles) return 0;
    for (whole i = m->first[removed]; i < m->first[removed + 1]; i++) {
        const whole *old = m->triangles + 3 * m->around[i];
        whole new[3];
        if (old[0] == kept || old[1] == kept || old[2] == kept) continue;
        for (int k = 0; k < 3; k++) {
            new[k] = old[k] == removed ? kept : old[k];
            if (old[k] != removed && ratio(m, old[k], kept) > longer) return 0;
        }
        const double before = pas_upright(old, m->points, m->normals);
        const double after = pas_upright(new, m->points, m->normals);
        if (after < (before < turned ? before : turned)) return 0;
    }
    return 1;
}

typedef struct {
    double ratio;
    whole row;
} Short;

static int by_ratio(const void *p, const void *q)
{
    const Short *a = p, *b = q;
    if (a->ratio != b->ratio) return a->ratio < b->ratio ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

typedef struct {
    whole removed, kept, common;
} Collapse;

/* The collapses of short edges in order of preference; how many. */
static whole candidates(Mesh *m, whole inner, const whole *rim, const char *fixed, double at_most, Short *order,
                        Collapse *found)
{
    whole shorts = 0, number = 0;
    for (whole e = 0; e < m->number; e++) {
        const double value = ratio(m, m->edges[2 * e], m->edges[2 * e + 1]);
        if (value < at_most) order[shorts++] = (Short){value, e};
    }
    qsort(order, shorts, sizeof(Short), by_ratio);
    for (whole i = 0; i < shorts; i++) {
        const whole e = order[i].row, a = m->edges[2 * e], b = m->edges[2 * e + 1];
        const int on_rim = e >= inner;
        const int free_a = rim[a] < 0 || (on_rim && !fixed[a]), free_b = rim[b] < 0 || (on_rim && !fixed[b]);
        if (free_b || free_a) found[number++] = (Collapse){free_b ? b : a, free_b ? a : b, on_rim ? 1 : 2};
    }
    return number;
}

/* The least rank of each vertex and those next to it, of collapses with an end there. */
static void spread(const Mesh *m, const Collapse *some, whole number, whole *own, whole *near)
{
    for (whole v = 0; v < m->size; v++) own[v] = number;
    for (whole i = number - 1; i >= 0; i--) own[some[i].removed] = own[some[i].kept] = i;
    memcpy(near, own, m->size * sizeof(whole));
    for (whole e = 0; e < m->number; e++) {
        const whole a = m->edges[2 * e], b = m->edges[2 * e + 1];
        if (own[b] < near[a]) near[a] = own[b];
        if (own[a] < near[b]) near[b] = own[a];
    }
}

static void rounds(Mesh *m, Collapse *some, whole number, int most, double turned, double longer, whole *target,
                   whole *own, whole *near, char *blocked, char *close)
{
    for (int round = 0; round < most && number; round++) {
        whole left = 0;
        spread(m, some, number, own, near);
        for (whole i = 0; i < number; i++) {
            const Collapse c = some[i];
            if (near[c.removed] != i || near[c.kept] != i) {
                some[left++] = c;
                continue;
            }
            if (!sound(m, c.removed, c.kept, c.common, turned, longer)) continue;
            target[c.removed] = c.kept;
            blocked[c.removed] = blocked[c.kept] = 1;
        }
        memcpy(close, blocked, m->size);
        for (whole e = 0; e < m->number; e++) {
            if (blocked[m->edges[2 * e]]) close[m->edges[2 * e + 1]] = 1;
            if (blocked[m->edges[2 * e + 1]]) close[m->edges[2 * e]] = 1;
        }
        number = 0;
        for (whole i = 0; i < left; i++)
            if (!close[some[i].removed] && !close[some[i].kept]) some[number++] = some[i];
    }
}

/* Into which vertex each goes, itself where it stays; `edges` are the inner ones, then those of the rim. */
int pas_collapsed(whole count, const whole *triangles, whole size, const double *points, const double *normals,
                  const double *sizes, whole number, whole inner, const whole *edges, const whole *rim,
                  const char *fixed, double at_most, double longer, double turned, whole most, whole *target)
{
    Mesh m = {size, count, number, triangles, edges, points, normals, sizes, NULL, NULL, NULL, NULL, NULL};
    Short *order = malloc((number + 1) * sizeof(Short));
    Collapse *some = malloc((number + 1) * sizeof(Collapse));
    whole *own = malloc((size + 1) * sizeof(whole)), *near = malloc((size + 1) * sizeof(whole));
    char *blocked = calloc(size + 1, 1), *close = malloc(size + 1);
    int state = look_around(&m);
    if (!order || !some || !own || !near || !blocked || !close) state = -1;
    for (whole v = 0; v < size; v++) target[v] = v;
    if (state == 0) {
        const whole found = candidates(&m, inner, rim, fixed, at_most, order, some);
        rounds(&m, some, found, most, turned, longer, target, own, near, blocked, close);
    }
    free(order); free(some); free(own); free(near); free(blocked); free(close);
    free(m.first); free(m.edge_first); free(m.around); free(m.next_to); free(m.seen);
    return state;
}
