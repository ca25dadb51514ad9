/* The three changes of a mesh of half edges: an edge is split, flipped, or collapsed.

   Collapses keep the topology: the link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999), and vertices on curves
   move along these alone.  Flips go towards Delaunay's criterion. */

#include <stdlib.h>
#include <string.h>

#include "halfedge.h"

#define TIE 1e-6 /* sine of what opposite angles must have above pi for a flip, so that ties stay */

static inline void pair(Mesh *m, whole g, whole h)
{
    if (g >= 0) m->twins[g] = h;
    if (h >= 0) m->twins[h] = g;
}

/* A wedge of a new vertex between two others; the mesh has room for it. */
static whole new_wedge(Mesh *m, whole vertex, whole label, whole i, whole j)
{
    const whole w = m->wedges++;
    double sum[3];
    for (int x = 0; x < 3; x++) sum[x] = m->normals[3 * i + x] + m->normals[3 * j + x];
    const double length = sqrt(larger(dot(sum, sum), 1e-300));
    for (int x = 0; x < 3; x++) m->normals[3 * w + x] = sum[x] / length;
    m->bends[w] = (m->bends[i] + m->bends[j]) / 2;
    m->vertex_of[w] = vertex;
    m->face_of[w] = label;
    return w;
}

/* Cut the triangle of half edge h, which ends at v from now on; the half edge from v to where it ended. */
static whole halved(Mesh *m, whole h, whole v, whole w)
{
    const whole h1 = next(h), h2 = previous(h), b = m->corners[h1], fresh = 3 * m->triangles++;
    m->label_of[fresh / 3] = m->label_of[h / 3];
    m->corners[fresh] = v;
    m->corners[fresh + 1] = b;
    m->corners[fresh + 2] = m->corners[h2];
    m->wedge_of[fresh] = w;
    m->wedge_of[fresh + 1] = m->wedge_of[h1];
    m->wedge_of[fresh + 2] = m->wedge_of[h2];
    m->twins[fresh + 1] = m->twins[h1];
    if (m->twins[h1] >= 0) m->twins[m->twins[h1]] = fresh + 1;
    m->corners[h1] = v;
    m->wedge_of[h1] = w;
    pair(m, h1, fresh + 2);
    if (m->outgoing[b] == h1) m->outgoing[b] = fresh + 1;
    return fresh;
}

static void split(Mesh *m, whole h)
{
    const whole g = m->twins[h], a = m->corners[h], b = end_of(m, h), v = m->vertices++;
    const int curve = on_curve(m, h);
    for (int x = 0; x < 3; x++) m->points[3 * v + x] = (m->points[3 * a + x] + m->points[3 * b + x]) / 2;
    m->sizes[v] = (m->sizes[a] + m->sizes[b]) / 2;
    m->caps[v] = smaller(m->caps[a], m->caps[b]);
    m->kinds[v] = curve ? ON_CURVE : INSIDE;
    m->marks[v] = 0;
    m->fresh[v] = 1;
    const whole w = new_wedge(m, v, m->label_of[h / 3], m->wedge_of[h], m->wedge_of[next(h)]);
    const whole after = halved(m, h, v, w);
    m->outgoing[v] = after;
    m->twins[after] = g;
    if (g < 0) return;
    const whole other = curve ? new_wedge(m, v, m->label_of[g / 3], m->wedge_of[g], m->wedge_of[next(g)]) : w;
    pair(m, h, halved(m, g, v, other));
    pair(m, after, g);
}

/* Split half edges one after the other, given with their ends (count, 2); the mesh has room. */
int pas_mesh_split(Mesh *m, whole count, const whole *halves, const whole *ends)
{
    for (whole i = 0; i < count; i++) {
        const whole a = ends[2 * i], b = ends[2 * i + 1];
        whole h = halves[i]; /* another one, where its triangle was cut */
        if (m->corners[h] != a || end_of(m, h) != b) h = between(m, a, b);
        if (h >= 0) split(m, h);
    }
    return 0;
}

/* Minus the sine of the sum of the angles at c and d, opposite to the edge from a to b. */
static double beyond(const Mesh *m, whole a, whole b, whole c, whole d)
{
    double p[3], q[3], r[3], s[3], u[3], v[3];
    minus(m->points + 3 * a, m->points + 3 * c, p);
    minus(m->points + 3 * b, m->points + 3 * c, q);
    minus(m->points + 3 * a, m->points + 3 * d, r);
    minus(m->points + 3 * b, m->points + 3 * d, s);
    const double cos_c = dot(p, q), cos_d = dot(r, s);
    if (cos_c >= 0 && cos_d >= 0) return 0.0; /* both are acute */
    cross(p, q, u);
    cross(r, s, v);
    const double sin_c = sqrt(dot(u, u)), sin_d = sqrt(dot(v, v));
    const double size = sqrt((cos_c * cos_c + sin_c * sin_c) * (cos_d * cos_d + sin_d * sin_d));
    return -(sin_c * cos_d + cos_c * sin_d) / larger(size, 1e-300);
}

/* Whether a flip turns no triangle away from the normals, makes no edge between opposite sides, and none twice. */
static int may_flip(const Mesh *m, whole h, double turned)
{
    const whole g = m->twins[h], a = m->corners[h], b = m->corners[g], c = apex_of(m, h), d = apex_of(m, g);
    const whole wa = m->wedge_of[h], wb = m->wedge_of[g], wc = m->wedge_of[previous(h)], wd = m->wedge_of[previous(g)];
    const double facing = dot(m->normals + 3 * wc, m->normals + 3 * wd);
    if (facing < 0 && facing < dot(m->normals + 3 * wa, m->normals + 3 * wb)) return 0;
    const double before = smaller(upright(m, a, b, c, wa, wb, wc), upright(m, b, a, d, wb, wa, wd));
    const double after = smaller(upright(m, c, a, d, wc, wa, wd), upright(m, c, d, b, wc, wd, wb));
    return after >= smaller(before, turned) && c != d && between(m, c, d) < 0;
}

static void flip(Mesh *m, whole h)
{
    const whole g = m->twins[h], h1 = next(h), h2 = previous(h), g1 = next(g), g2 = previous(g);
    const whole a = m->corners[h], b = m->corners[g], beside_h = m->twins[h1], beside_g = m->twins[g1];
    m->corners[h1] = m->corners[g2];
    m->wedge_of[h1] = m->wedge_of[g2];
    m->corners[g1] = m->corners[h2];
    m->wedge_of[g1] = m->wedge_of[h2];
    m->twins[h] = beside_g;
    m->twins[g] = beside_h;
    if (beside_g >= 0) m->twins[beside_g] = h;
    if (beside_h >= 0) m->twins[beside_h] = g;
    pair(m, h1, g1);
    if (m->outgoing[a] == g1) m->outgoing[a] = h;
    if (m->outgoing[b] == h1) m->outgoing[b] = g;
}

/* Whether the other diagonal is better: by Delaunay's criterion, or on ruled faces, where one is further from the face
   than `limit`, if it is nearer. */
static int better_flipped(const Mesh *m, whole h, double limit)
{
    const whole g = m->twins[h], a = m->corners[h], b = m->corners[g], c = apex_of(m, h), d = apex_of(m, g);
    if (m->faces[m->label_of[h / 3]] == RULED) {
        const double before = sag(m, a, b, m->wedge_of[h], m->wedge_of[g]);
        const double after = sag(m, c, d, m->wedge_of[previous(h)], m->wedge_of[previous(g)]);
        if (larger(before, after) > limit) return after < before * (1 - TIE);
    }
    return beyond(m, a, b, c, d) > TIE;
}

/* Flip edges, of those at fresh vertices or of all, until none is better flipped; each flip looks again at the edges
   around it.  At most so many `passes` through all edges' worth of flips, since rounding could go round in circles. */
int pas_mesh_flip(Mesh *m, double turned, double limit, whole only_fresh, whole passes)
{
    const whole most = passes * m->triangles;
    whole *stack = malloc((3 * m->triangles + 1) * sizeof(whole)), top = 0, flips = 0;
    char *waiting = calloc(3 * m->triangles + 1, 1);
    const int state = stack && waiting ? 0 : -1;
    for (whole h = 3 * m->triangles - 1; state == 0 && h >= 0; h--) {
        if (m->twins[h] < h || (only_fresh && !m->fresh[m->corners[h]] && !m->fresh[end_of(m, h)])) continue;
        stack[top++] = h;
        waiting[h] = 1;
    }
    while (top && flips < most) {
        const whole h = stack[--top], g = m->twins[h];
        waiting[h] = 0;
        if (on_curve(m, h) || !better_flipped(m, h, limit) || !may_flip(m, h, turned)) continue;
        flip(m, h);
        flips++;
        const whole beside[4] = {h, previous(h), g, previous(g)};
        for (int i = 0; i < 4; i++) {
            const whole e = beside[i], other = m->twins[e], one = other > e ? other : e;
            if (other < 0 || waiting[one]) continue;
            stack[top++] = one;
            waiting[one] = 1;
        }
    }
    free(stack);
    free(waiting);
    return state;
}

/* What a collapse must keep: `longer` is how long edges may be over what they should be, 0 for any length; `kept` and
   `held` are cosines between new triangles and their normals, the latter on ruled faces; `off` says how far new edges
   may be from curves and ruled faces, over the mesh's tolerances; `flat` is the least height over the longest side on
   ruled faces: of triangles that are made when a vertex on a curve goes, one inside, and one inside a plane. */
typedef struct {
    double longer, kept, held, off, flat[3];
} Limits;

/* The height of a triangle over its longest side. */
static double height(const Mesh *m, whole a, whole b, whole c)
{
    double n[3];
    across(m, a, b, c, n);
    const double longest = larger(distance(m, a, b), larger(distance(m, b, c), distance(m, c, a)));
    return sqrt(dot(n, n)) / larger(longest * longest, 1e-300);
}

static inline char face_at(const Mesh *m, whole h) { return m->plain ? BENT : m->faces[m->label_of[h / 3]]; }

static whole wedge_at(const Mesh *m, whole vertex, whole label)
{
    AROUND(m, vertex, h) if (m->label_of[h / 3] == label) return m->wedge_of[h];
    return -1;
}

static int has_triangle(const Mesh *m, whole v, whole a, whole b)
{
    AROUND(m, v, h) if (end_of(m, h) + apex_of(m, h) == a + b && (end_of(m, h) == a || end_of(m, h) == b)) return 1;
    return 0;
}

/* Whether what is next to both ends of half edge h, which ends in k, is next to the edge itself. */
static int keeps_topology(Mesh *m, whole h)
{
    const whole gone = m->corners[h], k = end_of(m, h), g = m->twins[h], c = apex_of(m, h);
    const whole d = g >= 0 ? apex_of(m, g) : -1, seen = ++m->stamp, counted = ++m->stamp;
    whole common = 0;
    AROUND(m, k, e) m->marks[end_of(m, e)] = m->marks[apex_of(m, e)] = seen;
    AROUND(m, gone, e)
    {
        const whole ends[2] = {end_of(m, e), apex_of(m, e)};
        for (int i = 0; i < 2; i++)
            if (m->marks[ends[i]] == seen) {
                common++;
                m->marks[ends[i]] = counted;
            }
    }
    if (c == d || common != (g < 0 ? 1 : 2)) return 0;
    return g < 0 || !(has_triangle(m, gone, c, d) && has_triangle(m, k, c, d));
}

/* Whether the sides of the triangle of half edge e, other than e, may become one: not both on the boundary, and where a
   lattice's mesh is not cleaned of islands of one triangle, not both on curves. */
static int may_close(const Mesh *m, whole e)
{
    const whole sides[2] = {next(e), previous(e)};
    if (m->plain) return m->twins[sides[0]] >= 0 || m->twins[sides[1]] >= 0;
    return !(on_curve(m, sides[0]) && on_curve(m, sides[1]));
}

/* Whether a vertex on a curve is near enough to the chord that is left when it goes along half edge h. */
static int keeps_curve(const Mesh *m, whole h, double off)
{
    const whole gone = m->corners[h], k = end_of(m, h), g = m->twins[h];
    whole other = -1;
    AROUND(m, gone, e)
    {
        if (on_curve(m, e) && end_of(m, e) != k) other = end_of(m, e);
        if (m->twins[previous(e)] < 0 && apex_of(m, e) != k) other = apex_of(m, e);
    }
    if (other < 0) return 0;
    double chord[3], way[3], n[3];
    minus(m->points + 3 * other, m->points + 3 * k, chord);
    minus(m->points + 3 * gone, m->points + 3 * k, way);
    cross(chord, way, n);
    const int ruled = m->faces[m->label_of[h / 3]] && (g < 0 || m->faces[m->label_of[g / 3]]);
    return sqrt(dot(n, n) / larger(dot(chord, chord), 1e-300)) <= off * (ruled ? m->fine : m->coarse);
}

/* Into how many parts half edge h will be cut: more than one only beside a face that is not ruled. */
static inline double parts_of(const Mesh *m, whole h)
{
    const whole g = m->twins[h];
    return g >= 0 && face_at(m, g) == BENT ? sqrt(m->coarse / m->fine) : 1;
}

/* The height over the longest side that triangles of a ruled face have after the cut, of that at half edge e if it had
   corner k instead of where e begins; beside the triangles that this takes away their other sides count. */
static double height_when_cut(const Mesh *m, whole e, whole k)
{
    const whole before = m->twins[e], after = m->twins[previous(e)];
    const whole first = before >= 0 && apex_of(m, before) == k ? previous(before) : e;
    const whole last = after >= 0 && apex_of(m, after) == k ? next(after) : previous(e);
    const double parts = larger(parts_of(m, first), larger(parts_of(m, next(e)), parts_of(m, last)));
    return height(m, k, end_of(m, e), apex_of(m, e)) / parts;
}

/* Whether a triangle with corner k, instead of the one at half edge e, is good on a ruled face. */
static int lies_flat(const Mesh *m, whole e, whole k, whole w, const Limits *l, double flattest)
{
    const whole a = end_of(m, e), b = apex_of(m, e), wa = m->wedge_of[next(e)], wb = m->wedge_of[previous(e)];
    const char face = face_at(m, e);
    const double most = l->off * m->fine, flat = l->flat[m->kinds[m->corners[e]] == INSIDE ? face : 0];
    if (height_when_cut(m, e, k) < smaller(flattest, flat)) return 0;
    if (face == RULED && (sag(m, k, a, w, wa) > most || sag(m, k, b, w, wb) > most)) return 0;
    double n[3];
    across(m, k, a, b, n);
    const double least = 0.5 * sqrt(dot(n, n)); /* so that no triangle goes through a bar */
    return dot(n, m->normals + 3 * w) >= least && dot(n, m->normals + 3 * wa) >= least &&
           dot(n, m->normals + 3 * wb) >= least;
}

/* Whether an edge is not too long, and not between opposite sides of the surface, where lengths count. */
static int short_enough(const Mesh *m, whole k, whole a, whole w, whole wa, double longer)
{
    if (longer <= 0) return 1;
    return 2 * distance(m, k, a) <= longer * (m->sizes[k] + m->sizes[a]) &&
           dot(m->normals + 3 * w, m->normals + 3 * wa) > 0;
}

/* Whether the triangles about a vertex stay good when it goes into k. */
static int keeps_triangles(const Mesh *m, whole gone, whole k, const Limits *l)
{
    double flattest = INFINITY;
    AROUND(m, gone, e) if (face_at(m, e)) flattest = smaller(flattest, height_when_cut(m, e, gone));
    AROUND(m, gone, e)
    {
        const whole a = end_of(m, e), b = apex_of(m, e);
        if (a == k || b == k) continue;
        const whole w = wedge_at(m, k, m->label_of[e / 3]);
        if (w < 0) return 0;
        const whole wa = m->wedge_of[next(e)], wb = m->wedge_of[previous(e)];
        if (!(upright(m, k, a, b, w, wa, wb) > (face_at(m, e) ? l->held : l->kept))) return 0;
        if (face_at(m, e) && !lies_flat(m, e, k, w, l, flattest)) return 0;
        if (!face_at(m, e) && !(short_enough(m, k, a, w, wa, l->longer) && short_enough(m, k, b, w, wb, l->longer)))
            return 0;
    }
    return 1;
}

static int may_collapse(Mesh *m, whole h, const Limits *l)
{
    const whole gone = m->corners[h], g = m->twins[h];
    if (m->kinds[gone] >= CORNER || (m->kinds[gone] == ON_CURVE && !on_curve(m, h))) return 0;
    if (!may_close(m, h) || (g >= 0 && !may_close(m, g)) || !keeps_topology(m, h)) return 0;
    if (m->kinds[gone] == ON_CURVE && !m->plain && !keeps_curve(m, h, l->off)) return 0;
    return keeps_triangles(m, gone, end_of(m, h), l);
}

/* Join what is beside the triangle of half edge e, which goes; a half edge that leaves k then. */
static whole closed(Mesh *m, whole e)
{
    const whole apex = apex_of(m, e), from_apex = m->twins[next(e)], into_apex = m->twins[previous(e)];
    if (from_apex >= 0) m->twins[from_apex] = into_apex;
    if (into_apex >= 0) m->twins[into_apex] = from_apex;
    m->outgoing[apex] = from_apex >= 0 ? from_apex : next(into_apex);
    return into_apex >= 0 ? into_apex : next(from_apex);
}

/* Turn to the first half edge about a vertex, on the boundary if there is one. */
static void turn_back(Mesh *m, whole v)
{
    const whole start = m->outgoing[v];
    whole h = start;
    while (m->twins[h] >= 0 && next(m->twins[h]) != start) h = next(m->twins[h]);
    m->outgoing[v] = m->twins[h] < 0 ? h : start;
}

static void collapse(Mesh *m, whole h)
{
    const whole gone = m->corners[h], k = end_of(m, h), g = m->twins[h], c = apex_of(m, h);
    const whole d = g >= 0 ? apex_of(m, g) : -1;
    AROUND(m, gone, e)
    {
        m->wedge_of[e] = wedge_at(m, k, m->label_of[e / 3]);
        m->corners[e] = k;
    }
    m->outgoing[k] = closed(m, h);
    if (g >= 0) closed(m, g);
    for (int i = 0; i < 3; i++) {
        m->corners[h / 3 * 3 + i] = -1;
        if (g >= 0) m->corners[g / 3 * 3 + i] = -1;
    }
    m->outgoing[gone] = -1;
    turn_back(m, k);
    turn_back(m, c);
    if (d >= 0) turn_back(m, d);
    m->kinds[k] = kind_of(m, k);
    m->kinds[c] = kind_of(m, c);
    if (d >= 0) m->kinds[d] = kind_of(m, d);
}

/* Whether each label has triangles left without those beside half edge h, of `left` by label. */
static int keeps_labels(const Mesh *m, whole h, const whole *left)
{
    const whole own = m->label_of[h / 3], other = m->twins[h] < 0 ? -1 : m->label_of[m->twins[h] / 3];
    return left[own] > 1 + (other == own) && (other < 0 || left[other] > 1 + (other == own));
}

/* The numbers of triangles by labels, to be freed; NULL without memory. */
static whole *triangles_left(const Mesh *m)
{
    whole most = 0;
    for (whole t = 0; t < m->triangles; t++)
        if (m->label_of[t] > most) most = m->label_of[t];
    whole *left = calloc(most + 1, sizeof(whole));
    for (whole t = 0; left && t < m->triangles; t++) left[m->label_of[t]]++;
    return left;
}

/* Collapse half edges, or else their twins, one after the other, none next to another one of this pass; `done` says how
   many.  The mesh is to be packed then; vertices whose triangles changed are fresh. */
int pas_mesh_collapse(Mesh *m, whole count, const whole *halves, const double *limits, whole *done)
{
    const Limits l = {limits[0], limits[1], limits[2], limits[3], {limits[4], limits[5], limits[6]}};
    char *blocked = calloc(m->vertices + 1, 1);
    whole *left = triangles_left(m);
    *done = 0;
    for (whole i = 0; blocked && left && i < count; i++) {
        const whole h = halves[i], a = m->corners[h], b = a < 0 ? -1 : end_of(m, h), g = m->twins[h];
        if (a < 0 || blocked[a] || blocked[b] || !keeps_labels(m, h, left)) continue;
        whole chosen = may_collapse(m, h, &l) ? h : -1;
        if (chosen < 0 && g >= 0 && may_collapse(m, g, &l)) chosen = g;
        if (chosen < 0) continue;
        const whole k = end_of(m, chosen);
        blocked[m->corners[chosen]] = 1;
        left[m->label_of[h / 3]]--;
        if (g >= 0) left[m->label_of[g / 3]]--;
        collapse(m, chosen);
        ++*done;
        blocked[k] = m->fresh[k] = 1;
        AROUND(m, k, e)
        {
            const whole ends[2] = {end_of(m, e), apex_of(m, e)};
            for (int x = 0; x < 2; x++) blocked[ends[x]] = m->fresh[ends[x]] = 1;
        }
    }
    const int state = blocked && left ? 0 : -1;
    free(blocked);
    free(left);
    return state;
}
