/* Vertices of a mesh of half edges moved to where triangles are better ones; they are put onto faces in between. */

#include <stdlib.h>
#include <string.h>

#include "halfedge.h"

/* Sums (4 a vertex) of the centres of triangles about each vertex, by area over size squared, and of these weights. */
static void centred(const Mesh *m, double *sums)
{
    for (whole t = 0; t < m->triangles; t++) {
        const whole *v = m->corners + 3 * t;
        double n[3];
        across(m, v[0], v[1], v[2], n);
        const double size = (m->sizes[v[0]] + m->sizes[v[1]] + m->sizes[v[2]]) / 3;
        const double weight = m->plain ? 1 : sqrt(dot(n, n)) / (size * size); /* folded ones have small areas */
        for (int i = 0; i < 3; i++) {
            const double share =
                (m->points[3 * v[0] + i] + m->points[3 * v[1] + i] + m->points[3 * v[2] + i]) / 3 * weight;
            for (int k = 0; k < 3; k++) sums[4 * v[k] + i] += share;
        }
        for (int k = 0; k < 3; k++) sums[4 * v[k] + 3] += weight;
    }
}

/* A vertex on a curve goes halfway to the middle between its neighbours there. */
static void along_curve(const Mesh *m, whole v, double *to)
{
    double sum[3] = {0, 0, 0};
    AROUND(m, v, h)
    {
        if (on_curve(m, h))
            for (int i = 0; i < 3; i++) sum[i] += m->points[3 * end_of(m, h) + i];
        if (m->twins[previous(h)] < 0)
            for (int i = 0; i < 3; i++) sum[i] += m->points[3 * apex_of(m, h) + i];
    }
    for (int i = 0; i < 3; i++) to[i] = m->points[3 * v + i] / 2 + sum[i] / 4;
}

/* Where vertices should go (V, 3): to the mean of their triangles' centres in the tangent plane, or along curves.
   Corners, what has no normal, such as an apex, and vertices on lines of ruled faces stay. */
int pas_mesh_targets(const Mesh *m, double *to)
{
    double *sums = calloc(4 * m->vertices + 1, sizeof(double));
    if (!sums) return -1;
    centred(m, sums);
    memcpy(to, m->points, 3 * m->vertices * sizeof(double));
    for (whole w = 0; w < m->wedges; w++) {
        const whole v = m->vertex_of[w];
        const double *n = m->normals + 3 * w, *sum = sums + 4 * v;
        if (m->kinds[v] != INSIDE || (!m->plain && m->faces[m->face_of[w]] == RULED) || !(dot(n, n) > 0.5)) continue;
        double move[3];
        for (int i = 0; i < 3; i++) move[i] = sum[i] / larger(sum[3], 1e-300) - m->points[3 * v + i];
        const double off = dot(move, n);
        for (int i = 0; i < 3; i++) to[3 * v + i] += move[i] - off * n[i];
    }
    for (whole v = 0; v < m->vertices; v++)
        if (m->kinds[v] == ON_CURVE) along_curve(m, v, to + 3 * v);
    free(sums);
    return 0;
}

/* The cosines (T) between triangles and the normals at their corners. */
int pas_mesh_cosines(const Mesh *m, double *cosines)
{
    for (whole t = 0; t < m->triangles; t++) cosines[t] = upright_at(m, t);
    return 0;
}

/* Put vertices that a turned triangle has back to where they were, and have the triangles about them looked at again;
   whether there are some. */
static int put_back(Mesh *m, whole t, const double *before, char *back, char *open)
{
    int more = 0;
    for (int k = 0; k < 3; k++) {
        const whole v = m->corners[3 * t + k];
        if (back[v]) continue;
        back[v] = more = 1;
        memcpy(m->points + 3 * v, before + 3 * v, 3 * sizeof(double));
        AROUND(m, v, h) open[h / 3] = 1;
    }
    return more;
}

/* Move vertices to points (V, 3), but those back of triangles that are then turned away from the old normals; wedges of
   the others get new normals (W, 3) and curvatures (W), if they are `known`. */
int pas_mesh_settle(Mesh *m, const double *to, const double *normals, const double *bends, whole known, double turned)
{
    const whole size = m->vertices, count = m->triangles;
    double *before = malloc((3 * size + count + 1) * sizeof(double)), *least = before + 3 * size;
    char *back = calloc(size + count + 1, 1), *open = back + size;
    const int state = before && back ? 0 : -1;
    if (state == 0) {
        memcpy(before, m->points, 3 * size * sizeof(double));
        for (whole t = 0; t < count; t++) least[t] = smaller(upright_at(m, t), turned);
        memcpy(m->points, to, 3 * size * sizeof(double));
        for (whole t = 0; t < count; t++) open[t] = 1;
    }
    for (int more = state == 0; more;) {
        more = 0;
        for (whole t = 0; t < count; t++) {
            if (!open[t]) continue;
            open[t] = 0;
            if (!(upright_at(m, t) >= least[t])) more |= put_back(m, t, before, back, open);
        }
    }
    for (whole w = 0; state == 0 && w < m->wedges; w++) {
        if (back[m->vertex_of[w]]) continue;
        memcpy(m->normals + 3 * w, normals + 3 * w, 3 * sizeof(double));
        if (known) m->bends[w] = bends[w];
    }
    free(before);
    free(back);
    return state;
}

/* The sines (T) of the smallest angles of triangles with a fresh corner, infinite of others. */
int pas_mesh_sines(const Mesh *m, double *sines)
{
    for (whole t = 0; t < m->triangles; t++) {
        const whole *v = m->corners + 3 * t;
        sines[t] = m->fresh[v[0]] | m->fresh[v[1]] | m->fresh[v[2]] ? sine(m, v[0], v[1], v[2]) : INFINITY;
    }
    return 0;
}

/* What the triangles about a vertex lack (the sum of squares below the aim), and the least sine, -1 of turned ones. */
static double lacking(const Mesh *m, whole v, const double *normal, double aim, double *least)
{
    double sum = 0;
    *least = INFINITY;
    AROUND(m, v, h)
    {
        double n[3];
        across(m, v, end_of(m, h), apex_of(m, h), n);
        const double found = dot(n, normal) > 0 ? sine(m, v, end_of(m, h), apex_of(m, h)) : -1;
        *least = smaller(*least, found);
        if (found < aim) sum += (aim - found) * (aim - found);
    }
    return sum;
}

/* Two directions at right angles in the tangent plane, as long as the mean edge opposite to a vertex. */
static void tangents(const Mesh *m, whole v, const double *normal, double *first, double *second)
{
    double reach = 0;
    whole count = 0;
    AROUND(m, v, h)
    {
        reach += distance(m, end_of(m, h), apex_of(m, h));
        count++;
    }
    minus(m->points + 3 * end_of(m, m->outgoing[v]), m->points + 3 * v, first);
    const double off = dot(first, normal);
    for (int i = 0; i < 3; i++) first[i] -= off * normal[i];
    const double length = sqrt(larger(dot(first, first), 1e-300));
    for (int i = 0; i < 3; i++) first[i] *= reach / ((double)count * length);
    cross(normal, first, second);
}

/* A place for a vertex where its triangles lack less, by looking around in smaller and smaller circles (after Freitag and
   Ollivier-Gooch 1997); none is then more slender than the worst was, or the aim.  Whether there is one. */
static int better_place(Mesh *m, whole v, double aim, double *best)
{
    static const double turns[8][2] = {{1, 0}, {0.7, 0.7}, {0, 1}, {-0.7, 0.7}, {-1, 0}, {-0.7, -0.7}, {0, -1}, {0.7, -0.7}};
    const double *normal = m->normals + 3 * m->wedge_of[m->outgoing[v]];
    double *place = m->points + 3 * v, here[3], first[3], second[3], least, floor;
    memcpy(here, place, sizeof(here));
    memcpy(best, place, sizeof(here));
    tangents(m, v, normal, first, second);
    const double start = lacking(m, v, normal, aim, &floor);
    double left = start, reach = 0.25;
    for (int round = 0; round < 4; round++, reach /= 2) {
        double middle[3];
        memcpy(middle, best, sizeof(middle));
        for (int way = 0; way < 8; way++) {
            for (int i = 0; i < 3; i++)
                place[i] = middle[i] + reach * (turns[way][0] * first[i] + turns[way][1] * second[i]);
            const double found = lacking(m, v, normal, aim, &least);
            if (!(least >= smaller(floor, aim) && found < left)) continue;
            left = found;
            memcpy(best, place, sizeof(here));
        }
    }
    memcpy(place, here, sizeof(here));
    return left < 0.98 * start;
}

/* Better places (count, 3) for some of the vertices given, none next to another: those first in line; which they are
   into `chosen`, and how many. */
int pas_mesh_better(Mesh *m, double aim, whole count, const whole *vertices, whole *chosen, double *places, whole *number)
{
    char *taken = calloc(m->vertices + 1, 1);
    if (!taken) return -1;
    *number = 0;
    for (whole i = 0; i < count; i++) {
        const whole v = vertices[i];
        if (taken[v] || !m->fresh[v]) continue;
        m->fresh[v] = 0;
        if (!better_place(m, v, aim, places + 3 * *number)) continue;
        chosen[(*number)++] = v;
        taken[v] = 1;
        AROUND(m, v, h) taken[end_of(m, h)] = taken[apex_of(m, h)] = 1;
    }
    free(taken);
    return 0;
}

/* The triangles about vertices: as rows, and the number of the vertex in the list; into `number` how many.  Where `rows`
   is too small, only their number is right. */
int pas_mesh_stars(const Mesh *m, whole count, const whole *vertices, whole room, whole *rows, whole *owners, whole *number)
{
    *number = 0;
    for (whole i = 0; i < count; i++)
        AROUND(m, vertices[i], h)
        {
            if (*number < room) {
                rows[*number] = h / 3;
                owners[*number] = i;
            }
            ++*number;
        }
    return 0;
}

/* Put vertices inside faces, if they are `good`, at places with normals there, but where triangles get more slender than
   the worst was, or the aim, or are turned away; how many went into `moved`. */
int pas_mesh_move(Mesh *m, whole count, const whole *vertices, const double *places, const double *normals, const char *good,
             double aim, double held, whole *moved)
{
    *moved = 0;
    for (whole i = 0; i < count; i++) {
        if (!good[i]) continue;
        const whole v = vertices[i], w = m->wedge_of[m->outgoing[v]];
        double *place = m->points + 3 * v, *normal = m->normals + 3 * w, here[3], old[3], floor, least;
        memcpy(here, place, sizeof(here));
        memcpy(old, normal, sizeof(old));
        lacking(m, v, old, aim, &floor);
        memcpy(place, places + 3 * i, sizeof(here));
        memcpy(normal, normals + 3 * i, sizeof(old));
        lacking(m, v, normal, aim, &least);
        AROUND(m, v, h) if (!(upright_at(m, h / 3) >= held)) least = -1;
        if (least < smaller(floor, aim)) {
            memcpy(place, here, sizeof(here));
            memcpy(normal, old, sizeof(old));
            continue;
        }
        AROUND(m, v, h) m->fresh[end_of(m, h)] = m->fresh[apex_of(m, h)] = 1;
        m->fresh[v] = 1;
        ++*moved;
    }
    return 0;
}
