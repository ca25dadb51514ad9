/* Each triangle of a mesh of half edges cut into q^2, the new points on cubics that follow the normals at its corners.

   Of ruled faces only the edges beside others are cut, and their triangles become fans. */

#include "halfedge.h"

/* A mesh that is made: triangles (3 corners, 3 codes of boundary curves or -1), their labels, and points. */
typedef struct {
    double *points;
    whole *corners, *codes, *labels, triangles, vertices;
} Made;

/* An old mesh with how its edges are cut: into q parts, whose points begin at `base` (3 T), -1 where an edge is not. */
typedef struct {
    const Mesh *m;
    const whole *base;
    whole q;
} Cut;

static inline int is_bent(const Mesh *m, whole h) { return m->faces[m->label_of[h / 3]] == BENT; }

/* Where the new points of half edges begin (3 T), and how many vertices and triangles there will be. */
int pas_mesh_cut_counts(const Mesh *m, whole q, whole *base, whole *counts)
{
    counts[0] = m->vertices;
    counts[1] = 0;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        const whole g = m->twins[h];
        const int cut = is_bent(m, h) || (g >= 0 && is_bent(m, g));
        base[h] = g >= 0 && g < h ? base[g] : cut ? counts[0] : -1;
        if (cut && !(g >= 0 && g < h)) counts[0] += q - 1;
    }
    for (whole t = 0; t < m->triangles; t++) {
        const whole *b = base + 3 * t;
        counts[1] += is_bent(m, 3 * t) ? q * q : 1 + (q - 1) * ((b[0] >= 0) + (b[1] >= 0) + (b[2] >= 0));
        if (is_bent(m, 3 * t)) counts[0] += (q - 1) * (q - 2) / 2;
    }
    return 0;
}

/* How far the chord of an edge is off the tangents at its ends: of a curve, off the lines tangent to both faces. */
static void off_tangents(const Mesh *m, whole h, double *first, double *last)
{
    const whole g = m->twins[h], wedges[2] = {m->wedge_of[h], m->wedge_of[next(h)]};
    const whole others[2] = {g >= 0 ? m->wedge_of[next(g)] : -1, g >= 0 ? m->wedge_of[g] : -1};
    double chord[3], *ways[2] = {first, last};
    minus(m->points + 3 * end_of(m, h), m->points + 3 * m->corners[h], chord);
    for (int k = 0; k < 2; k++) {
        const double *n = m->normals + 3 * wedges[k], off = dot(chord, n);
        for (int i = 0; i < 3; i++) ways[k][i] = off * n[i];
        if (g < 0 || !on_curve(m, h)) continue;
        double along[3];
        cross(n, m->normals + 3 * others[k], along);
        const double square = dot(along, along);
        if (square < 1e-4) continue; /* the faces are tangent to each other */
        const double share = dot(chord, along) / square;
        for (int i = 0; i < 3; i++) ways[k][i] = chord[i] - share * along[i];
    }
}

static void points_on_edges(const Cut *cut, Made *made)
{
    const Mesh *m = cut->m;
    for (whole h = 0; h < 3 * m->triangles; h++) {
        if (cut->base[h] < 0 || (m->twins[h] >= 0 && m->twins[h] < h)) continue;
        const double *a = m->points + 3 * m->corners[h], *b = m->points + 3 * end_of(m, h);
        double first[3], last[3], *place = made->points + 3 * cut->base[h];
        off_tangents(m, h, first, last);
        for (whole i = 1; i < cut->q; i++) {
            const double s = (double)i / (double)cut->q, x = s * (1 - s) * (1 - s), y = s * s * (1 - s);
            for (int c = 0; c < 3; c++) *place++ = (1 - s) * a[c] + s * b[c] - x * first[c] + y * last[c];
        }
    }
}

/* The vertex that is so many parts along a half edge. */
static whole along(const Cut *cut, whole h, whole parts)
{
    const Mesh *m = cut->m;
    const int back = m->twins[h] >= 0 && m->twins[h] < h;
    if (parts == 0 || parts == cut->q) return m->corners[parts ? next(h) : h];
    return cut->base[h] + (back ? cut->q - parts : parts) - 1;
}

static inline whole code_of(const Cut *cut, whole h) { return cut->m->twins[h] < 0 ? cut->m->twins[h] : -1; }

static void put(Made *made, whole label, const whole *corners, const whole *codes)
{
    for (int k = 0; k < 3; k++) {
        made->corners[3 * made->triangles + k] = corners[k];
        made->codes[3 * made->triangles + k] = codes[k];
    }
    made->labels[made->triangles++] = label;
}

/* The triangles between an apex and the points of half edge h from `begin` to `end`; codes of the sides there. */
static void fan(const Cut *cut, Made *made, whole h, whole apex, whole begin, whole end, whole code_begin, whole code_end)
{
    const whole step = cut->base[h] < 0 ? cut->q : 1;
    for (whole i = begin; i < end; i += step) {
        const whole corners[3] = {along(cut, h, i), along(cut, h, i + step), apex};
        const whole codes[3] = {code_of(cut, h), i + step >= end ? code_end : -1, i == begin ? code_begin : -1};
        put(made, cut->m->label_of[h / 3], corners, codes);
    }
}

/* The triangle of a ruled face: one side after the other, that of which triangle it is part by then, becomes a fan. */
static void fans(const Cut *cut, Made *made, whole t)
{
    const whole h = 3 * t, q = cut->q, *v = cut->m->corners + h;
    const int cut_first = cut->base[h] >= 0, cut_second = cut->base[h + 1] >= 0;
    if (cut_first) fan(cut, made, h, v[2], 1, q - 1, -1, -1); /* but for the first and the last */
    const whole apex = cut_first ? along(cut, h, q - 1) : v[0];
    const whole last = cut_second ? q - 1 : 0; /* where the part of the second side begins that the third one shares */
    const whole before = code_of(cut, h);
    if (cut_first) {
        fan(cut, made, h + 1, apex, 0, q, before, -1);
        fan(cut, made, h + 2, along(cut, h, 1), 0, q, -1, before);
        return;
    }
    if (last) fan(cut, made, h + 1, apex, 0, last, before, -1);
    fan(cut, made, h + 2, along(cut, h + 1, last), 0, q, code_of(cut, h + 1), last ? -1 : before);
}

/* The points of a bent triangle's lattice: how far edges bow out, blended inside. */
static void points_inside(const Cut *cut, Made *made, whole t)
{
    const Mesh *m = cut->m;
    const whole *v = m->corners + 3 * t, q = cut->q;
    double bow[3][3];
    for (int k = 0; k < 3; k++) {
        const double *n = m->normals + 3 * m->wedge_of[3 * t + k], *o = m->normals + 3 * m->wedge_of[3 * t + (k + 1) % 3];
        double chord[3];
        minus(m->points + 3 * v[(k + 1) % 3], m->points + 3 * v[k], chord);
        const double first = dot(chord, n), last = dot(chord, o);
        for (int c = 0; c < 3; c++) bow[k][c] = last * o[c] - first * n[c];
    }
    for (whole i = 1; i < q; i++)
        for (whole j = 1; i + j < q; j++) {
            const double w[3] = {(double)(q - i - j) / (double)q, (double)i / (double)q, (double)j / (double)q};
            double *place = made->points + 3 * made->vertices++;
            for (int c = 0; c < 3; c++) {
                place[c] = 0;
                for (int k = 0; k < 3; k++)
                    place[c] += w[k] * m->points[3 * v[k] + c] + 0.5 * w[k] * w[(k + 1) % 3] * bow[k][c];
            }
        }
}

/* The vertex of a bent triangle's lattice, i parts towards the second corner and j towards the third; those inside begin
   at `inside`. */
static whole lattice(const Cut *cut, whole t, whole i, whole j, whole inside)
{
    const whole q = cut->q, h = 3 * t;
    if (j == 0) return along(cut, h, i);
    if (i + j == q) return along(cut, h + 1, j);
    if (i == 0) return along(cut, h + 2, q - j);
    return inside + (i - 1) * (q - 1) - (i - 1) * i / 2 + j - 1; /* rows of q - 2, q - 3, ... */
}

static void parts(const Cut *cut, Made *made, whole t)
{
    const whole q = cut->q, h = 3 * t, label = cut->m->label_of[t], inside = made->vertices;
    points_inside(cut, made, t);
    for (whole i = 0; i < q; i++)
        for (whole j = 0; i + j < q; j++) {
            const whole a = lattice(cut, t, i, j, inside), b = lattice(cut, t, i + 1, j, inside);
            const whole c = lattice(cut, t, i, j + 1, inside), up[3] = {a, b, c};
            const whole codes[3] = {j ? -1 : code_of(cut, h), i + j < q - 1 ? -1 : code_of(cut, h + 1),
                                    i ? -1 : code_of(cut, h + 2)};
            put(made, label, up, codes);
            if (i + j == q - 1) continue;
            const whole down[3] = {b, lattice(cut, t, i + 1, j + 1, inside), c}, none[3] = {-1, -1, -1};
            put(made, label, down, none);
        }
}

/* The points, corners (T, 3), codes of the boundary curves of half edges (T, 3) and labels after a cut into q parts;
   `base` is that of `pas_mesh_cut_counts`, and arrays have room for what that says. */
int pas_mesh_cut(const Mesh *m, whole q, const whole *base, double *points, whole *corners, whole *codes, whole *labels)
{
    const Cut cut = {m, base, q};
    Made made = {points, corners, codes, labels, 0, m->vertices};
    for (whole i = 0; i < 3 * m->vertices; i++) points[i] = m->points[i];
    for (whole h = 0; h < 3 * m->triangles; h++)
        if (base[h] >= 0 && !(m->twins[h] >= 0 && m->twins[h] < h)) made.vertices += q - 1;
    points_on_edges(&cut, &made);
    for (whole t = 0; t < m->triangles; t++)
        if (is_bent(m, 3 * t))
            parts(&cut, &made, t);
        else
            fans(&cut, &made, t);
    return 0;
}
