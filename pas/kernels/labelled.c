/* Tables and flips of closed meshes whose triangles carry labels.

   They serve pas/mesh/labelled.py and remesh.py.  A function that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"
#include "vectors.h"

/* Half edges by their lower and then their higher vertex: number 3 t + k leads from corner k of triangle t to the next.
   `first` (size + 1) is where those of each lower vertex begin in `order`. */
typedef struct {
    whole *order, *high, *first;
} Halves;

static Halves halves_in(whole *room, whole count)
{
    return (Halves){room, room + 3 * count, room + 6 * count};
}

static inline whole start_of(const whole *triangles, whole half) { return triangles[half]; }

static inline whole end_of(const whole *triangles, whole half)
{
    return triangles[half % 3 == 2 ? half - 2 : half + 1];
}

static inline whole apex_of(const whole *triangles, whole half)
{
    return triangles[half % 3 == 0 ? half + 2 : half - 1];
}

/* Equal edges stand by corners, then by triangles.  Only triangles that are `chosen` count, if that is given. */
static void sort_halves(Halves *h, const whole *triangles, whole count, whole size, const char *chosen)
{
    memset(h->first, 0, (size + 1) * sizeof(whole));
    for (whole half = 0; half < 3 * count; half++) {
        if (chosen && !chosen[half / 3]) continue;
        const whole a = start_of(triangles, half), b = end_of(triangles, half);
        h->first[(a < b ? a : b) + 1]++;
    }
    for (whole v = 0; v < size; v++) h->first[v + 1] += h->first[v];
    for (int k = 0; k < 3; k++)
        for (whole half = k; half < 3 * count; half += 3) {
            if (chosen && !chosen[half / 3]) continue;
            const whole a = start_of(triangles, half), b = end_of(triangles, half);
            const whole at = h->first[a < b ? a : b]++;
            h->order[at] = half;
            h->high[at] = a < b ? b : a;
        }
    for (whole v = size; v > 0; v--) h->first[v] = h->first[v - 1];
    h->first[0] = 0;
    for (whole v = 0; v < size; v++) /* few of each vertex: by insertion */
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

static int has_edge(const Halves *h, whole a, whole b)
{
    const whole low = a < b ? a : b, high = a < b ? b : a;
    for (whole i = h->first[low]; i < h->first[low + 1]; i++)
        if (h->high[i] == high) return 1;
    return 0;
}

/* The edges, sorted, and the labels of both triangles of each. */
int pas_labelled_edges(whole count, const whole *triangles, const whole *labels, whole size, whole *room, whole *edges,
                       whole *both)
{
    Halves h = halves_in(room, count);
    sort_halves(&h, triangles, count, size, NULL);
    for (whole v = 0, i = 0; v < size; v++)
        for (; i + 1 < h.first[v + 1]; i += 2) {
            const whole a = labels[h.order[i] / 3], b = labels[h.order[i + 1] / 3];
            edges[i] = v;
            edges[i + 1] = h.high[i];
            both[i] = a < b ? a : b;
            both[i + 1] = a < b ? b : a;
        }
    return 0;
}

/* The distinct keys of (vertex, label) pairs, sorted, and which of them each corner has; `number` of them. */
int pas_labelled_pairs(whole count, const whole *triangles, const whole *labels, whole size, whole span, whole *room,
                       whole *keys, whole *rows, whole *number)
{
    whole *order = room, *first = room + 3 * count, found = 0;
    memset(first, 0, (size + 1) * sizeof(whole));
    for (whole corner = 0; corner < 3 * count; corner++) first[triangles[corner] + 1]++;
    for (whole v = 0; v < size; v++) first[v + 1] += first[v];
    for (whole corner = 0; corner < 3 * count; corner++) order[first[triangles[corner]]++] = corner;
    for (whole v = 0, i = 0; v < size; v++) { /* `first` now says where those of each vertex end */
        const whole begin = found;
        for (whole j = i; j < first[v]; j++) {
            const whole key = v * span + labels[order[j] / 3];
            whole at = begin;
            while (at < found && keys[at] != key) at++;
            if (at < found) continue;
            for (at = found++; at > begin && keys[at - 1] > key; at--) keys[at] = keys[at - 1];
            keys[at] = key;
        }
        for (; i < first[v]; i++) {
            const whole key = v * span + labels[order[i] / 3];
            whole at = begin;
            while (keys[at] != key) at++;
            rows[order[i]] = at;
        }
    }
    *number = found;
    return 0;
}

static inline void summed(const double *normals, const whole *rows, double *sum)
{
    for (int x = 0; x < 3; x++) sum[x] = normals[3 * rows[0] + x] + normals[3 * rows[1] + x] + normals[3 * rows[2] + x];
}

/* The cosines between the normals of chosen triangles and the sums of those given for their corners. */
int pas_cosines(whole number, const whole *chosen, const whole *triangles, const whole *corners, const double *points,
                const double *normals, double *cosines)
{
    for (whole i = 0; i < number; i++) {
        const whole *t = triangles + 3 * chosen[i];
        double u[3], v[3], area[3], normal[3];
        minus(points + 3 * t[1], points + 3 * t[0], u);
        minus(points + 3 * t[2], points + 3 * t[0], v);
        cross(u, v, area);
        summed(normals, corners + 3 * chosen[i], normal);
        const double size = sqrt(dot(area, area) * dot(normal, normal));
        cosines[i] = dot(area, normal) / (size > 1e-300 ? size : 1e-300);
    }
    return 0;
}

/* The mean length of the edges at each vertex, or of those that are `seams`, where there are some; `room` is (size). */
int pas_sizes(whole number, const whole *edges, const double *lengths, const char *seams, whole size, whole *room,
              double *total, double *sizes)
{
    for (whole v = 0; v < size; v++) sizes[v] = 1.0;
    for (int pass = 0; pass < 2; pass++) {
        memset(room, 0, size * sizeof(whole));
        memset(total, 0, size * sizeof(double));
        for (int side = 0; side < 2; side++)
            for (whole e = 0; e < number; e++) {
                if (pass && !seams[e]) continue;
                total[edges[2 * e + side]] += lengths[e];
                room[edges[2 * e + side]]++;
            }
        for (whole v = 0; v < size; v++)
            if (room[v]) sizes[v] = total[v] / (double)room[v];
    }
    return 0;
}

/* Cosine and sine, times the same positive factor, of the angle at a vertex. */
static void angle(const double *points, whole at, whole a, whole b, double *cosine, double *sine)
{
    double u[3], v[3], w[3];
    minus(points + 3 * a, points + 3 * at, u);
    minus(points + 3 * b, points + 3 * at, v);
    cross(u, v, w);
    *cosine = dot(u, v);
    *sine = sqrt(dot(w, w));
}

static double beyond(const double *points, whole a, whole b, whole c, whole d)
{
    double cos_c, sin_c, cos_d, sin_d;
    angle(points, c, a, b, &cos_c, &sin_c);
    angle(points, d, a, b, &cos_d, &sin_d);
    const double size = sqrt((cos_c * cos_c + sin_c * sin_c) * (cos_d * cos_d + sin_d * sin_d));
    return -(sin_c * cos_d + cos_c * sin_d) / (size > 1e-300 ? size : 1e-300);
}

static double sag(const double *points, whole a, whole b, const double *at_a, const double *at_b)
{
    double along[3], turn[3];
    minus(points + 3 * b, points + 3 * a, along);
    minus(at_b, at_a, turn);
    return fabs(dot(along, turn)) / 8;
}

static int keeps_side(const double *points, whole p, whole q, whole r, const double *about)
{
    double u[3], v[3], area[3];
    minus(points + 3 * q, points + 3 * p, u);
    minus(points + 3 * r, points + 3 * p, v);
    cross(u, v, area);
    return dot(area, about) > 0.5 * sqrt(dot(area, area)) * sqrt(dot(about, about));
}

typedef struct {
    double gain;
    whole row, i, j;
} Flip;

static int by_gain(const void *p, const void *q)
{
    const Flip *a = p, *b = q;
    if (a->gain != b->gain) return a->gain > b->gain ? -1 : 1;
    return a->row < b->row ? -1 : a->row > b->row;
}

/* A mesh whose edges are flipped.  `corners` are rows of `normals` for each corner, `facing` (count, 3) the way that
   each triangle should face, the sum of these; `lines` says on which there are straight lines (NULL if that does not matter). */
typedef struct {
    whole count, size, *triangles, *corners;
    const whole *labels;
    const double *points, *normals;
    double *facing;
    const char *lines;
    double limit;
} Faces;

/* What is gained by flipping the edge of two half edges. */
static double gain_of(const Faces *f, whole i, whole j)
{
    const whole a = start_of(f->triangles, i), b = end_of(f->triangles, i);
    const whole c = apex_of(f->triangles, i), d = apex_of(f->triangles, j);
    if (f->lines && f->lines[i / 3]) {
        const double *at_a = f->normals + 3 * start_of(f->corners, i), *at_b = f->normals + 3 * end_of(f->corners, i);
        const double *at_c = f->normals + 3 * apex_of(f->corners, i), *at_d = f->normals + 3 * apex_of(f->corners, j);
        const double before = sag(f->points, a, b, at_a, at_b), after = sag(f->points, c, d, at_c, at_d);
        if ((before > after ? before : after) > f->limit && before != after) return before > after ? 2.0 : -2.0;
    }
    return beyond(f->points, a, b, c, d);
}

/* Flips that are a gain and allowed, in the order of the edges. */
static whole candidates(const Faces *f, const Halves *h, const char *near, Flip *found)
{
    whole number = 0;
    for (whole v = 0; v < f->size; v++)
        for (whole k = h->first[v]; k + 1 < h->first[v + 1]; k++) {
            const whole i = h->order[k], j = h->order[k + 1];
            if (h->high[k] != h->high[k + 1] || f->labels[i / 3] != f->labels[j / 3]) continue;
            const double gain = gain_of(f, i, j);
            if (!(gain > 1e-6)) continue;
            const whole a = start_of(f->triangles, i), b = end_of(f->triangles, i);
            const whole c = apex_of(f->triangles, i), d = apex_of(f->triangles, j);
            if (near && !near[c] && !near[d]) continue;
            double about[3];
            for (int x = 0; x < 3; x++) about[x] = f->facing[i / 3 * 3 + x] + f->facing[j / 3 * 3 + x];
            if (!keeps_side(f->points, c, a, d, about) || !keeps_side(f->points, c, d, b, about)) continue;
            if (has_edge(h, c, d)) continue;
            found[number] = (Flip){gain, number, i, j};
            number++;
        }
    return number;
}

static void turn(whole *table, whole i, whole j)
{
    const whole a = start_of(table, i), b = end_of(table, i), c = apex_of(table, i), d = apex_of(table, j);
    whole *first = table + i / 3 * 3, *second = table + j / 3 * 3;
    first[0] = c; first[1] = a; first[2] = d;
    second[0] = c; second[1] = d; second[2] = b;
}

/* Do those that touch no triangle and make no edge twice, the best first; how many.  `heads` (size) are -1. */
static whole apply(Faces *f, Flip *flips, whole number, char *taken, char *near, whole *heads, whole *next)
{
    whole done = 0;
    qsort(flips, number, sizeof(Flip), by_gain);
    for (whole k = 0; k < number; k++) {
        const whole i = flips[k].i, j = flips[k].j;
        if (taken[i / 3] || taken[j / 3]) continue;
        const whole c = apex_of(f->triangles, i), d = apex_of(f->triangles, j), low = c < d ? c : d;
        whole known = heads[low];
        while (known >= 0 && flips[known].row != c + d - low) known = next[known];
        if (known >= 0) continue;
        taken[i / 3] = taken[j / 3] = 1;
        flips[k].row = c + d - low; /* from here on the higher end of the new edge */
        next[k] = heads[low];
        heads[low] = k;
        for (int x = 0; x < 3; x++) {
            const double half = (f->facing[i / 3 * 3 + x] + f->facing[j / 3 * 3 + x]) / 2;
            f->facing[i / 3 * 3 + x] = f->facing[j / 3 * 3 + x] = half;
        }
        turn(f->corners, i, j);
        turn(f->triangles, i, j);
        for (int x = 0; x < 3; x++) near[f->triangles[i / 3 * 3 + x]] = near[f->triangles[j / 3 * 3 + x]] = 1;
        done++;
    }
    return done;
}

/* Flip edges in some passes; `near` (size) says about which vertices if `bounded`, and is written to, as is `facing`. */
int pas_flipped_faces(whole count, whole *triangles, whole *corners, const whole *labels, whole size, whole *room,
                      const double *points, const double *normals, double *facing, const char *lines, whole lined,
                      double limit, char *near, whole bounded, whole passes, whole *flipped)
{
    Faces f = {count, size, triangles, corners, labels, points, normals, facing, lined ? lines : NULL, limit};
    Halves h = halves_in(room, count);
    Flip *flips = malloc((3 * count / 2 + 1) * sizeof(Flip));
    char *chosen = malloc(count + 1), *taken = malloc(count + 1);
    whole *heads = malloc((size + 1) * sizeof(whole)), *next = malloc((3 * count / 2 + 1) * sizeof(whole));
    const int good = flips && chosen && taken && heads && next;
    *flipped = 0;
    for (whole t = 0; t < count; t++) summed(normals, corners + 3 * t, facing + 3 * t);
    for (whole pass = 0; good && pass < passes; pass++) {
        for (whole t = 0; t < count; t++) {
            const whole *v = triangles + 3 * t;
            chosen[t] = !bounded || near[v[0]] || near[v[1]] || near[v[2]];
        }
        sort_halves(&h, triangles, count, size, bounded ? chosen : NULL);
        const whole number = candidates(&f, &h, bounded ? near : NULL, flips);
        memset(taken, 0, count);
        memset(near, 0, size);
        memset(heads, -1, size * sizeof(whole));
        const whole done = apply(&f, flips, number, taken, near, heads, next);
        *flipped += done;
        bounded = 1;
        if (!done) break;
    }
    free(flips);
    free(chosen);
    free(taken);
    free(heads);
    free(next);
    return good ? 0 : -1;
}
