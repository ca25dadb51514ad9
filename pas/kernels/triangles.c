/* What is done again and again to make the triangles of a mesh good ones: edges, flips, moves, collapses.

   They serve pas/mesh/radial.py, graded.py and coarsen.py.  Points and normals are rows of three doubles,
   triangles rows of three numbers.  A function that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"
#include "vectors.h"

static inline void across(const double *points, whole a, whole b, whole c, double *normal)
{
    double u[3], v[3];
    minus(points + 3 * b, points + 3 * a, u);
    minus(points + 3 * c, points + 3 * a, v);
    cross(u, v, normal);
}

static inline double least_of(double a, double b) { return a < b ? a : b; }

/* The cosine between a triangle and the sum of the normals at its corners. */
static inline double turned_from(const double *points, const double *normals, whole a, whole b, whole c)
{
    double n[3], total[3];
    across(points, a, b, c, n);
    for (int i = 0; i < 3; i++) total[i] = normals[3 * a + i] + normals[3 * b + i] + normals[3 * c + i];
    const double size = dot(n, n) * dot(total, total);
    return dot(n, total) / sqrt(size > 1e-300 ? size : 1e-300);
}

double pas_upright(const whole *triangle, const double *points, const double *normals)
{
    return turned_from(points, normals, triangle[0], triangle[1], triangle[2]);
}

int pas_uprights(whole count, const whole *triangles, const double *points, const double *normals, double *cosines)
{
    for (whole t = 0; t < count; t++) cosines[t] = pas_upright(triangles + 3 * t, points, normals);
    return 0;
}

/* Half edges by their lower and then their higher vertex: half edge 4 t + k leads from corner k of triangle t to the
   next.  `first` (size + 1) is where those of each lower vertex begin in `order`. */
typedef struct {
    whole count, size, *order, *high, *first;
} Halves;

static inline whole owner_of(whole half) { return half >> 2; }

static inline whole from(const whole *triangles, whole half) { return triangles[3 * (half >> 2) + (half & 3)]; }

static inline whole to(const whole *triangles, whole half)
{
    return triangles[3 * (half >> 2) + ((half & 3) == 2 ? 0 : (half & 3) + 1)];
}

static inline whole opposite(const whole *triangles, whole half)
{
    return triangles[3 * (half >> 2) + ((half & 3) == 0 ? 2 : (half & 3) - 1)];
}

/* Fill a table whose arrays have room; equal edges stand by corners, then by triangles. */
static void sort_halves(Halves *h, const whole *triangles)
{
    const whole count = h->count;
    memset(h->first, 0, (h->size + 1) * sizeof(whole));
    for (int k = 0; k < 3; k++)
        for (whole t = 0; t < count; t++) {
            const whole a = triangles[3 * t + k], b = triangles[3 * t + (k + 1) % 3];
            h->first[(a < b ? a : b) + 1]++;
        }
    for (whole v = 0; v < h->size; v++) h->first[v + 1] += h->first[v];
    for (int k = 0; k < 3; k++)
        for (whole t = 0; t < count; t++) {
            const whole a = triangles[3 * t + k], b = triangles[3 * t + (k + 1) % 3];
            const whole place = h->first[a < b ? a : b]++;
            h->order[place] = 4 * t + k;
            h->high[place] = a < b ? b : a;
        }
    for (whole v = h->size; v > 0; v--) h->first[v] = h->first[v - 1];
    h->first[0] = 0;
    for (whole v = 0; v < h->size; v++) /* few of each vertex: by insertion */
        for (whole i = h->first[v] + 1; i < h->first[v + 1]; i++) {
            const whole order = h->order[i], high = h->high[i];
            whole j = i;
            for (; j > h->first[v] && h->high[j - 1] > high; j--) {
                h->order[j] = h->order[j - 1];
                h->high[j] = h->high[j - 1];
            }
            h->order[j] = order;
            h->high[j] = high;
        }
}

/* A table in room for 6 count + size + 2 numbers. */
static Halves halves_in(whole *room, whole count, whole size)
{
    return (Halves){count, size, room, room + 3 * count, room + 6 * count};
}

static int has_edge(const Halves *h, whole a, whole b)
{
    const whole low = a < b ? a : b, high = a < b ? b : a;
    for (whole i = h->first[low]; i < h->first[low + 1]; i++)
        if (h->high[i] == high) return 1;
    return 0;
}

/* Sort the half edges in `room`, unless they are there, and say how many inner edges there are, how many on the rim, and
   if it is a manifold. */
int pas_edges(whole count, const whole *triangles, whole size, whole *room, whole sorted, whole *sizes)
{
    Halves h = halves_in(room, count, size);
    sizes[0] = sizes[1] = 0;
    sizes[2] = 1;
    if (!sorted) sort_halves(&h, triangles);
    for (whole v = 0; v < size; v++)
        for (whole i = h.first[v]; i < h.first[v + 1]; i++) {
            const int last = i + 1 == h.first[v + 1] || h.high[i + 1] != h.high[i];
            const int start = i == h.first[v] || h.high[i - 1] != h.high[i];
            sizes[0] += !last;
            sizes[1] += last && start;
            if (!last && (!start || from(triangles, h.order[i]) != to(triangles, h.order[i + 1]))) sizes[2] = 0;
        }
    return 0;
}

/* The inner edges, then those of the rim; and the two triangles of each inner one. */
int pas_listed(whole count, const whole *triangles, whole size, whole *room, whole inner, whole *every, whole *owners)
{
    const Halves h = halves_in(room, count, size);
    whole within = 0, alone = inner;
    for (whole v = 0; v < size; v++)
        for (whole i = h.first[v]; i < h.first[v + 1]; i++) {
            const int last = i + 1 == h.first[v + 1] || h.high[i + 1] != h.high[i];
            const int start = i == h.first[v] || h.high[i - 1] != h.high[i];
            if (last && !start) continue;
            const whole row = last ? alone++ : within++;
            every[2 * row] = from(triangles, h.order[i]);
            every[2 * row + 1] = to(triangles, h.order[i]);
            if (last) continue;
            owners[2 * row] = owner_of(h.order[i]);
            owners[2 * row + 1] = owner_of(h.order[i + 1]);
        }
    return 0;
}

/* Something that is done in the order of a number, the first of equal ones first. */
typedef struct {
    double value;
    whole row;
} Ranked;

static int by_value(const void *p, const void *q)
{
    const Ranked *a = p, *b = q;
    if (a->value != b->value) return a->value < b->value ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

/* Minus the sine of the sum of the angles at c and d opposite to a, b, or 0 where it is not positive for sure. */
static double beyond(const double *points, whole a, whole b, whole c, whole d)
{
    double p[3], q[3], r[3], s[3], u[3], v[3];
    minus(points + 3 * a, points + 3 * c, p);
    minus(points + 3 * b, points + 3 * c, q);
    minus(points + 3 * a, points + 3 * d, r);
    minus(points + 3 * b, points + 3 * d, s);
    const double cos_c = dot(p, q), cos_d = dot(r, s);
    if (cos_c >= 0 && cos_d >= 0) return 0.0; /* both acute: it is no more than that */
    cross(p, q, u);
    cross(r, s, v);
    const double sin_c = sqrt(dot(u, u)), sin_d = sqrt(dot(v, v));
    const double size = sqrt((cos_c * cos_c + sin_c * sin_c) * (cos_d * cos_d + sin_d * sin_d));
    return -(sin_c * cos_d + cos_c * sin_d) / (size > 1e-300 ? size : 1e-300);
}

static int flip_allowed(const double *points, const double *normals, whole a, whole b, whole c, whole d, double turned)
{
    const double across = dot(normals + 3 * c, normals + 3 * d);
    if (across < 0 && across < dot(normals + 3 * a, normals + 3 * b)) return 0;
    const double before = least_of(turned_from(points, normals, a, b, c), turned_from(points, normals, b, a, d));
    const double after = least_of(turned_from(points, normals, c, a, d), turned_from(points, normals, c, d, b));
    return after >= least_of(before, turned);
}

/* Whether the half edges in `room` are in the end those of the triangles, sorted, into `sorted`. */
int pas_flipped(whole count, whole *triangles, whole size, whole *room, const double *points, const double *normals,
                whole passes, double gain, double turned, whole *sorted)
{
    Halves h = halves_in(room, count, size);
    Ranked *wanted = malloc((3 * count + 1) * sizeof(Ranked));
    whole *pairs = malloc((6 * count + 1) * sizeof(whole)), *first = malloc((count + 1) * sizeof(whole));
    int state = wanted && pairs && first ? 0 : -1;
    *sorted = 0;
    for (int pass = 0; state == 0 && pass < passes; pass++) {
        whole number = 0, done = 0;
        sort_halves(&h, triangles);
        for (whole v = 0; v < size; v++)
            for (whole i = h.first[v]; i + 1 < h.first[v + 1]; i++) {
                if (h.high[i] != h.high[i + 1]) continue;
                const whole one = h.order[i], other = h.order[i + 1];
                const whole a = from(triangles, one), b = to(triangles, one);
                const whole c = opposite(triangles, one), d = opposite(triangles, other);
                const double value = beyond(points, a, b, c, d);
                if (!(value > gain) || !flip_allowed(points, normals, a, b, c, d, turned) || has_edge(&h, c, d))
                    continue;
                wanted[number] = (Ranked){-value, number};
                pairs[2 * number] = one;
                pairs[2 * number + 1] = other;
                number++;
            }
        qsort(wanted, number, sizeof(Ranked), by_value);
        for (whole t = 0; t < count; t++) first[t] = number;
        for (whole rank = number - 1; rank >= 0; rank--)
            for (int side = 0; side < 2; side++) first[owner_of(pairs[2 * wanted[rank].row + side])] = rank;
        for (whole rank = 0; rank < number; rank++) {
            const whole one = pairs[2 * wanted[rank].row], other = pairs[2 * wanted[rank].row + 1];
            const whole s = owner_of(one), t = owner_of(other);
            if (first[s] != rank || first[t] != rank) continue;
            const whole a = from(triangles, one), b = to(triangles, one);
            const whole c = opposite(triangles, one), d = opposite(triangles, other);
            const whole new[6] = {c, a, d, c, d, b};
            memcpy(triangles + 3 * s, new, 3 * sizeof(whole));
            memcpy(triangles + 3 * t, new + 3, 3 * sizeof(whole));
            done++;
        }
        if (!done) {
            *sorted = 1;
            break;
        }
    }
    free(wanted);
    free(pairs);
    free(first);
    return state;
}

/* Lengths that grow by at most `grade` over the way from each point to the next, in three rounds. */
int pas_grown(whole count, const whole *edges, whole size, const double *points, double grade, double *lengths)
{
    double *ways = malloc((count + 1) * sizeof(double)), *grown = malloc((size + 1) * sizeof(double));
    const int state = ways && grown ? 0 : -1;
    for (whole e = 0; state == 0 && e < count; e++) {
        double way[3];
        minus(points + 3 * edges[2 * e + 1], points + 3 * edges[2 * e], way);
        ways[e] = grade * sqrt(dot(way, way));
    }
    for (int round = 0; state == 0 && round < 3; round++) {
        memcpy(grown, lengths, size * sizeof(double));
        for (whole e = 0; e < count; e++) {
            const whole a = edges[2 * e], b = edges[2 * e + 1];
            grown[a] = least_of(lengths[b] + ways[e], grown[a]);
            grown[b] = least_of(lengths[a] + ways[e], grown[b]);
        }
        memcpy(lengths, grown, size * sizeof(double));
    }
    free(ways);
    free(grown);
    return state;
}

/* The way from each vertex to the mean of its triangles' centres, by their area over their size squared. */
int pas_centred(whole count, const whole *triangles, whole size, const double *points, const double *sizes,
                double *moves)
{
    double *weights = calloc(size + 1, sizeof(double));
    if (!weights) return -1;
    memset(moves, 0, 3 * size * sizeof(double));
    for (whole t = 0; t < count; t++) {
        const whole *v = triangles + 3 * t;
        const double *a = points + 3 * v[0], *b = points + 3 * v[1], *c = points + 3 * v[2];
        double n[3];
        across(points, v[0], v[1], v[2], n);
        const double mean = (sizes[v[0]] + sizes[v[1]] + sizes[v[2]]) / 3;
        const double weight = sqrt(dot(n, n)) / (mean * mean);
        for (int i = 0; i < 3; i++) {
            const double share = (a[i] + b[i] + c[i]) / 3 * weight;
            for (int k = 0; k < 3; k++) moves[3 * v[k] + i] += share;
        }
        for (int k = 0; k < 3; k++) weights[v[k]] += weight;
    }
    for (whole v = 0; v < size; v++)
        for (int i = 0; i < 3; i++)
            moves[3 * v + i] = moves[3 * v + i] / (weights[v] > 1e-300 ? weights[v] : 1e-300) - points[3 * v + i];
    free(weights);
    return 0;
}

int pas_settled(whole count, const whole *triangles, whole size, const double *before, double *after,
                const double *normals, double turned)
{
    double *least = malloc((count + 1) * sizeof(double));
    char *back = malloc(size + 1);
    int state = least && back ? 0 : -1, moved = 1;
    for (whole t = 0; state == 0 && t < count; t++) {
        const whole *v = triangles + 3 * t;
        least[t] = least_of(turned_from(before, normals, v[0], v[1], v[2]), turned);
    }
    while (state == 0 && moved) {
        moved = 0;
        memset(back, 0, size);
        for (whole t = 0; t < count; t++) {
            const whole *v = triangles + 3 * t;
            if (turned_from(after, normals, v[0], v[1], v[2]) < least[t]) back[v[0]] = back[v[1]] = back[v[2]] = 1;
        }
        for (whole v = 0; v < size; v++)
            for (int i = 0; back[v] && i < 3; i++)
                if (after[3 * v + i] != before[3 * v + i]) {
                    moved = 1;
                    after[3 * v + i] = before[3 * v + i];
                }
    }
    free(least);
    free(back);
    return state;
}
