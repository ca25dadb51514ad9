/* Which collapses of edges of a mesh with labels are done together, for pas/mesh/collapse.py.  A function
   that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"
#include "vectors.h"

/* `corners` are the rows of `normals` for each corner of the triangles; `first` (size + 1) says where the corners of
   each vertex begin in `around`; `seen` (size) are marks of numbers of collapses. */
typedef struct {
    whole count, size, number;
    const whole *triangles, *corners, *labels, *edges, *label_count;
    const double *points, *normals;
    whole *first, *around, *seen;
} FaceTable;

/* How near new edges must be to their faces at each vertex, and how slender new triangles may be: for each of `span`
   labels where vertices on curves go, then where those inside do.  Both may be NULL. */
typedef struct {
    const double *most, *slenderest;
    whole span;
    double kept, held, turned;
} Limits;

static int look_around(FaceTable *m)
{
    m->first = calloc(m->size + 2, sizeof(whole));
    m->around = malloc((3 * m->count + 1) * sizeof(whole));
    m->seen = malloc((m->size + 1) * sizeof(whole));
    if (!m->first || !m->around || !m->seen) return -1;
    for (whole i = 0; i < 3 * m->count; i++) m->first[m->triangles[i] + 1]++;
    for (whole v = 0; v < m->size; v++) m->first[v + 1] += m->first[v];
    for (whole i = 0; i < 3 * m->count; i++) m->around[m->first[m->triangles[i]]++] = i;
    for (whole v = m->size; v > 0; v--) m->first[v] = m->first[v - 1];
    m->first[0] = 0;
    for (whole v = 0; v < m->size; v++) m->seen[v] = -1;
    return 0;
}

static inline whole next(whole corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/* The row of the normal of a vertex's face with a label; -1 where it has none. */
static whole row_of(const FaceTable *m, whole vertex, whole label)
{
    for (whole i = m->first[vertex]; i < m->first[vertex + 1]; i++)
        if (m->labels[m->around[i] / 3] == label) return m->corners[m->around[i]];
    return -1;
}

/* The height of a triangle over its longest side. */
static double height(const double *a, const double *b, const double *c)
{
    double sides[3][3], area[3], longest;
    minus(b, a, sides[0]);
    minus(c, b, sides[1]);
    minus(a, c, sides[2]);
    cross(sides[0], sides[1], area);
    longest = dot(sides[0], sides[0]);
    for (int i = 1; i < 3; i++) {
        const double square = dot(sides[i], sides[i]);
        if (square > longest) longest = square;
    }
    return sqrt(dot(area, area)) / (longest > 1e-300 ? longest : 1e-300);
}

/* Whether the new edges are near enough to their faces when a vertex moves to `kept`. */
static int keeps_straight(const FaceTable *m, whole removed, whole kept, double most)
{
    const int sides = m->label_count[removed] > 1 ? 2 : 1; /* on curves edges have two faces */
    for (whole i = m->first[removed]; i < m->first[removed + 1]; i++) {
        const whole corner = m->around[i], at_kept = row_of(m, kept, m->labels[corner / 3]);
        if (at_kept < 0) return 0;
        whole there = corner;
        for (int side = 0; side < sides; side++) {
            there = next(there);
            const whole end = m->triangles[there];
            double along[3], turn[3];
            if (end == kept) continue;
            minus(m->points + 3 * end, m->points + 3 * kept, along);
            minus(m->normals + 3 * m->corners[there], m->normals + 3 * at_kept, turn);
            if (fabs(dot(along, turn)) / 8 > most) return 0;
        }
    }
    return 1;
}

/* The link condition: whether two vertices alone are next to both ends. */
static int keeps_topology(const FaceTable *m, whole number, whole removed, whole kept)
{
    int both = 0;
    for (whole i = m->first[kept]; i < m->first[kept + 1]; i++) {
        const whole b = next(m->around[i]);
        m->seen[m->triangles[b]] = m->seen[m->triangles[next(b)]] = number;
    }
    for (whole i = m->first[removed]; i < m->first[removed + 1]; i++)
        both += m->seen[m->triangles[next(m->around[i])]] == number;
    return both == 2;
}

/* Whether every triangle around a vertex is on its side of the face when the vertex moves to `kept`. */
static int keeps_orientation(const FaceTable *m, const Limits *l, whole removed, whole kept)
{
    const double *target = m->points + 3 * kept;
    double flattest = INFINITY;
    for (whole i = m->first[removed]; l->slenderest && i < m->first[removed + 1]; i++) {
        const whole *old = m->triangles + m->around[i] / 3 * 3;
        const double before = height(m->points + 3 * old[0], m->points + 3 * old[1], m->points + 3 * old[2]);
        if (before < flattest) flattest = before;
    }
    for (whole i = m->first[removed]; i < m->first[removed + 1]; i++) {
        const whole t = m->around[i] / 3, *old = m->triangles + 3 * t;
        const double *p[3], *own[3];
        double u[3], v[3], area[3], normal[3];
        if (old[0] == kept || old[1] == kept || old[2] == kept) continue;
        const whole at_kept = row_of(m, kept, m->labels[t]);
        if (at_kept < 0) return 0;
        for (int k = 0; k < 3; k++) {
            p[k] = old[k] == removed ? target : m->points + 3 * old[k];
            own[k] = m->normals + 3 * (old[k] == removed ? at_kept : m->corners[3 * t + k]);
        }
        minus(p[1], p[0], u);
        minus(p[2], p[0], v);
        cross(u, v, area);
        for (int x = 0; x < 3; x++) normal[x] = own[0][x] + own[1][x] + own[2][x];
        const double least = l->slenderest ? l->held : l->kept, square = dot(area, area);
        if (dot(area, normal) <= least * sqrt(square * dot(normal, normal))) return 0;
        if (!l->slenderest) continue;
        for (int k = 0; k < 3; k++)
            if (dot(own[k], area) < l->turned * sqrt(square)) return 0;
        const double allowed = l->slenderest[(m->label_count[removed] == 1) * l->span + m->labels[t]];
        if (height(p[0], p[1], p[2]) < (flattest < allowed ? flattest : allowed)) return 0;
    }
    return 1;
}

/* The least value of each vertex and those next to it. */
static void spread(const FaceTable *m, const whole *values, whole *result)
{
    memcpy(result, values, m->size * sizeof(whole));
    for (whole e = 0; e < m->number; e++) {
        const whole a = m->edges[2 * e], b = m->edges[2 * e + 1];
        if (values[b] < result[a]) result[a] = values[b];
        if (values[a] < result[b]) result[b] = values[a];
    }
}

/* The least numbers of collapses that cannot be done together with those at each vertex: `room` is (4, size). */
static void touching(const FaceTable *m, const whole *rows, whole some, const char *among, whole none, const whole *removed,
                     const whole *kept, whole *room)
{
    whole *at_removed = room, *at_either = room + m->size;
    for (whole v = 0; v < m->size; v++) at_removed[v] = none;
    for (whole i = some - 1; i >= 0; i--) /* ascending numbers: the least is written last */
        if (!among || among[rows[i]]) at_removed[removed[rows[i]]] = rows[i];
    memcpy(at_either, at_removed, m->size * sizeof(whole));
    for (whole i = some - 1; i >= 0; i--)
        if ((!among || among[rows[i]]) && rows[i] < at_either[kept[rows[i]]]) at_either[kept[rows[i]]] = rows[i];
    spread(m, at_either, room + 2 * m->size);
    spread(m, at_removed, room + 3 * m->size);
}

static whole first_of(const FaceTable *m, const whole *room, whole removed, whole kept)
{
    const whole *at_either = room + m->size, *near_either = room + 2 * m->size, *near_removed = room + 3 * m->size;
    whole result = near_either[removed];
    if (near_removed[kept] < result) result = near_removed[kept];
    return at_either[kept] < result ? at_either[kept] : result;
}

/* In rounds those that come before all others that touch them; `rows` are those that are sound, and are written to. */
static void rounds(const FaceTable *m, whole most, whole *rows, whole some, whole none, const whole *removed,
                   const whole *kept, char *chosen, whole *room)
{
    for (whole round = 0; round < most && some; round++) {
        whole left = 0;
        touching(m, rows, some, NULL, none, removed, kept, room);
        for (whole i = 0; i < some; i++) chosen[rows[i]] = first_of(m, room, removed[rows[i]], kept[rows[i]]) == rows[i];
        touching(m, rows, some, chosen, none, removed, kept, room);
        for (whole i = 0; i < some; i++)
            if (first_of(m, room, removed[rows[i]], kept[rows[i]]) == none) rows[left++] = rows[i];
        some = left;
    }
}

/* Which of some collapses of `removed` into `kept` vertices are done together, earlier ones preferred. */
int pas_merged_faces(whole count, const whole *triangles, const whole *corners, const whole *labels, whole size,
                     const double *points, const double *normals, whole number, const whole *edges,
                     const whole *label_count, whole some, const whole *removed, const whole *kept, const double *most,
                     whole straight, const double *slenderest, whole span, double upright, double held, double turned,
                     whole most_rounds, char *chosen)
{
    FaceTable m = {count, size, number, triangles, corners, labels, edges, label_count, points, normals, NULL, NULL, NULL};
    const Limits l = {straight ? most : NULL, span ? slenderest : NULL, span, upright, held, turned};
    whole *rows = malloc((some + 1) * sizeof(whole)), *room = malloc((4 * size + 1) * sizeof(whole)), sound = 0;
    int state = look_around(&m);
    if (!rows || !room) state = -1;
    memset(chosen, 0, some);
    for (whole i = 0; state == 0 && i < some; i++) {
        const whole a = removed[i], b = kept[i];
        if (l.most && !keeps_straight(&m, a, b, l.most[a])) continue;
        if (keeps_topology(&m, i, a, b) && keeps_orientation(&m, &l, a, b)) rows[sound++] = i;
    }
    if (state == 0) rounds(&m, most_rounds, rows, sound, some, removed, kept, chosen, room);
    free(rows);
    free(room);
    free(m.first);
    free(m.around);
    free(m.seen);
    return state;
}
