/* The tetrahedra of cubes that are halved where needed, for pas/mesh/octree.py.

   A node of a level is the number of its coordinates, 18 bits each.  A function that finds no memory returns -1. */

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"

#define BITS 18
#define MASK (((whole)1 << BITS) - 1)

static const whole weights[3] = {(whole)1 << 2 * BITS, (whole)1 << BITS, 1};

/* Numbers, listed in the order in which they came; -1 are empty slots, of which there are a power of two. */
typedef struct {
    whole *slots, *list, count, size;
} Set;

static size_t slot_of(const Set *s, whole key)
{
    size_t at = (size_t)((uint64_t)key * UINT64_C(0x9E3779B97F4A7C15) >> 20) & (size_t)(s->size - 1);
    while (s->slots[at] >= 0 && s->slots[at] != key) at = (at + 1) & (size_t)(s->size - 1);
    return at;
}

static int grown(Set *s)
{
    const whole size = s->size ? 2 * s->size : 1024;
    whole *slots = malloc(size * sizeof(whole)), *list = realloc(s->list, size / 2 * sizeof(whole));
    if (list) s->list = list;
    if (!slots || !list) {
        free(slots);
        return -1;
    }
    free(s->slots);
    s->slots = slots;
    s->size = size;
    memset(slots, -1, size * sizeof(whole));
    for (whole i = 0; i < s->count; i++) slots[slot_of(s, list[i])] = list[i];
    return 0;
}

static int add(Set *s, whole key)
{
    if (2 * s->count >= s->size && grown(s)) return -1;
    const size_t at = slot_of(s, key);
    if (s->slots[at] < 0) s->list[s->count++] = s->slots[at] = key;
    return 0;
}

static int has(const Set *s, whole key) { return s->size && s->slots[slot_of(s, key)] >= 0; }

static void apart(whole key, whole *c)
{
    c[0] = key >> 2 * BITS;
    c[1] = key >> BITS & MASK;
    c[2] = key & MASK;
}

static whole number_of(const whole *c) { return c[0] * weights[0] + c[1] * weights[1] + c[2]; }

static int odd(const whole *c) { return (int)((c[0] & 1) + (c[1] & 1) + (c[2] & 1)); }

/* `used` are all middles of each level, `cubes` those of cubes, sorted; `missed` are the cubes not passed. */
typedef struct {
    whole levels;
    const whole *counts;
    Set *used, *missed;
    whole **cubes, *number;
} Tree;

/* Whether a cube is in the grid and was not missed, nor was one that it is part of. */
static int exists(const Tree *t, whole level, const whole *cube)
{
    whole at[3], up[3];
    for (int x = 0; x < 3; x++) {
        at[x] = cube[x] >> 1;
        if (cube[x] < 0 || at[x] >> level >= t->counts[x]) return 0;
    }
    for (whole i = 0; i <= level; i++) {
        for (int x = 0; x < 3; x++) up[x] = 2 * (at[x] >> i) + 1;
        if (has(t->missed + level - i, number_of(up))) return 0;
    }
    return 1;
}

static int by_number(const void *p, const void *q)
{
    const whole a = *(const whole *)p, b = *(const whole *)q;
    return a < b ? -1 : a > b;
}

/* The middles of a level: those of halved cubes, what finer cubes need, and what both need; all that coarser cubes must
   have for these is added to the level above. */
static int middles(Tree *t, whole level, const whole *halved, whole count)
{
    Set *s = t->used + level;
    whole c[3], d[3];
    for (whole i = 0; i < count; i++)
        for (int k = 0; k < 27; k++) {
            const whole o[3] = {k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1};
            if (o[0] && o[1] && o[2]) continue;
            if (add(s, halved[i] + number_of(o))) return -1;
        }
    for (whole i = 0, known = s->count; i < known; i++) {
        apart(s->list[i], c);
        if (odd(c) != 1) continue;
        const int axis = c[0] & 1 ? 0 : c[1] & 1 ? 1 : 2, b = axis ? 0 : 1, e = axis == 2 ? 1 : 2;
        for (int k = 0; k < 4; k++) {
            const whole first = k & 1 ? 1 : -1, second = k & 2 ? 1 : -1;
            memcpy(d, c, sizeof d);
            d[b] += first;
            d[e] += second;
            if (!exists(t, level, d)) continue;
            if (add(s, s->list[i] + first * weights[b]) || add(s, s->list[i] + second * weights[e])) return -1;
        }
    }
    for (whole i = 0, known = s->count; i < known; i++) {
        apart(s->list[i], c);
        if (odd(c) != 2) continue;
        const int axis = !(c[0] & 1) ? 0 : !(c[1] & 1) ? 1 : 2;
        for (whole side = -1; side < 2; side += 2) {
            memcpy(d, c, sizeof d);
            d[axis] += side;
            if (exists(t, level, d) && add(s, number_of(d))) return -1;
        }
    }
    if (!(t->cubes[level] = malloc((s->count + 1) * sizeof(whole)))) return -1;
    for (whole i = 0; i < s->count; i++) {
        apart(s->list[i], c);
        if (odd(c) == 3) t->cubes[level][t->number[level]++] = s->list[i];
    }
    qsort(t->cubes[level], t->number[level], sizeof(whole), by_number);
    for (whole i = 0; level && i < t->number[level]; i++) {
        apart(t->cubes[level][i], c);
        for (int k = 0; k < 8; k++) {
            for (int x = 0; x < 3; x++) d[x] = (c[x] + (k >> x & 1 ? 1 : -1)) >> 1;
            if (odd(d) && add(t->used + level - 1, number_of(d))) return -1;
        }
    }
    return 0;
}

typedef struct {
    whole *corners, count, room;
} Found;

static int put(Found *f, whole a, whole b, whole c, whole d, whole shift)
{
    if (f->count == f->room) {
        whole *corners = realloc(f->corners, 8 * (f->room + 4096) * sizeof(whole));
        if (!corners) return -1;
        f->corners = corners;
        f->room = 2 * (f->room + 4096);
    }
    whole *to = f->corners + 4 * f->count++;
    to[0] = a << shift;
    to[1] = b << shift;
    to[2] = c << shift;
    to[3] = d << shift;
    return 0;
}

/* The tetrahedra of the halved cubes of a level on one side, but for eighths that are halved or missed.  There is room for
   two marks of each cube. */
static int cut_side(const Tree *t, whole level, int axis, whole out, Found *f, char *halved)
{
    char *cut = halved + t->number[level];
    const Set *used = t->used + level, *missed = t->missed + level + 1;
    const Set *finer = level + 1 < t->levels ? t->used + level + 1 : NULL;
    const whole *cubes = t->cubes[level], count = t->number[level], shift = t->levels - 1 - level;
    const int b = axis ? 0 : 1, c = axis == 2 ? 1 : 2;
    const whole plus = weights[b] + weights[c], minus = weights[b] - weights[c];
    for (whole i = 0; i < count; i++) halved[i] = (char)has(used, cubes[i] + out);
    for (int turned = 0; turned < 2; turned++)
        for (whole sign = -1; sign < 2; sign += 2)
            for (whole i = 0; i < count; i++) {
                whole at[3];
                if (halved[i]) continue;
                apart(cubes[i], at);
                if (((at[b] + at[c]) >> 1 & 1) == turned) continue;
                const whole face = cubes[i] + out, along = turned ? minus : plus, across = turned ? plus : minus;
                if (put(f, cubes[i], face - along, face + along, face + sign * across, shift)) return -1;
            }
    for (int k = 0; k < 4; k++) {
        const whole step = (k & 1 ? 1 : -1) * weights[k < 2 ? b : c], along = weights[k < 2 ? c : b];
        for (whole i = 0; i < count; i++) {
            const whole face = cubes[i] + out, edge = face + step;
            cut[i] = (char)has(used, edge);
            if (halved[i] && !cut[i] && put(f, cubes[i], face, edge - along, edge + along, shift)) return -1;
        }
        for (whole end = -along; end <= along; end += 2 * along)
            for (whole i = 0; i < count; i++) {
                const whole face = cubes[i] + out, edge = face + step, eighth = 2 * cubes[i] + out + step + end;
                if (!cut[i] || has(missed, eighth) || (finer && has(finer, eighth))) continue;
                if (put(f, cubes[i], face, edge, edge + end, shift)) return -1;
            }
    }
    return 0;
}

/* All tetrahedra; the cubes that are halved on each level, and those missed on each and one more, end where `ends` say.
   `found` is how many there are, and where they are until `pas_tetrahedra_taken`. */
int pas_tetrahedra(whole levels, const whole *halved, const whole *halved_ends, const whole *missed,
                   const whole *missed_ends, const whole *counts, whole *found)
{
    Tree t = {levels, counts, calloc(levels, sizeof(Set)), calloc(levels + 1, sizeof(Set)),
              calloc(levels, sizeof(whole *)), calloc(levels, sizeof(whole))};
    Found f = {NULL, 0, 0};
    char *marks = NULL;
    int state = t.used && t.missed && t.cubes && t.number ? 0 : -1;
    for (whole level = 0; state == 0 && level <= levels; level++)
        for (whole i = missed_ends[level]; state == 0 && i < missed_ends[level + 1]; i++)
            state = add(t.missed + level, missed[i]);
    for (whole level = levels - 1; state == 0 && level >= 0; level--)
        state = middles(&t, level, halved + halved_ends[level], halved_ends[level + 1] - halved_ends[level]);
    for (whole level = 0; state == 0 && level < levels; level++) {
        free(marks);
        state = (marks = malloc(2 * t.number[level] + 1)) ? 0 : -1;
        for (int k = 0; state == 0 && k < 6; k++)
            state = cut_side(&t, level, k / 2, k & 1 ? weights[k / 2] : -weights[k / 2], &f, marks);
    }
    for (whole level = 0; level <= levels; level++) {
        if (t.missed) free(t.missed[level].slots), free(t.missed[level].list);
        if (level == levels) break;
        if (t.used) free(t.used[level].slots), free(t.used[level].list);
        if (t.cubes) free(t.cubes[level]);
    }
    free(t.used);
    free(t.missed);
    free(t.cubes);
    free(t.number);
    free(marks);
    if (state) free(f.corners);
    found[0] = f.count;
    found[1] = (whole)(intptr_t)f.corners;
    return state;
}

/* The tetrahedra (count, 4) at a place, which is given back. */
int pas_tetrahedra_taken(whole count, whole place, whole *corners)
{
    whole *found = (whole *)(intptr_t)place;
    if (count) memcpy(corners, found, 4 * count * sizeof(whole));
    free(found);
    return 0;
}
