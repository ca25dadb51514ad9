/* Whether the triangles around vertices are one closed fan, as in pas/mesh/topology.py.  A function that finds no memory
   returns -1. */

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "pas.h"

enum { FINE, OPEN, PINCHED };

/* The sides opposite to a vertex are given by their ends: whether each end is one of two of them, and all are a ring. */
static char kind_of(const whole *sides, whole count, char *seen)
{
    for (whole i = 0; i < 2 * count; i++) {
        whole times = 0;
        for (whole j = 0; j < 2 * count; j++) times += sides[j] == sides[i];
        if (times != 2) return OPEN;
    }
    memset(seen, 0, count);
    whole at = sides[1], passed = 1;
    seen[0] = 1;
    while (at != sides[0]) {
        whole i = 0;
        while (seen[i] || (sides[2 * i] != at && sides[2 * i + 1] != at)) i++;
        seen[i] = 1;
        at = sides[2 * i] == at ? sides[2 * i + 1] : sides[2 * i];
        passed++;
    }
    return passed == count ? FINE : PINCHED;
}

/* Whether no end is in more than two of the sides, and those with common ends are one path or ring. */
static int is_fan(const whole *sides, whole count, char *seen)
{
    for (whole i = 0; i < 2 * count; i++) {
        whole times = 0;
        for (whole j = 0; j < 2 * count; j++) times += sides[j] == sides[i];
        if (times > 2) return 0;
    }
    whole passed = 1;
    memset(seen, 0, count);
    for (int end = 0; end < 2; end++) {
        whole at = sides[end];
        seen[0] = 1;
        for (whole i = 0; i < count; i++)
            if (!seen[i] && (sides[2 * i] == at || sides[2 * i + 1] == at)) {
                at = sides[2 * i] == at ? sides[2 * i + 1] : sides[2 * i];
                seen[i] = 1;
                passed++;
                i = -1;
            }
    }
    return passed == count;
}

/* The sides opposite to each vertex (6 count), by their ends, and where those of each end (size + 2); the most of one
   vertex, -1 without memory.  Both are to be freed. */
static whole sides_of(whole count, const whole *triangles, whole size, whole **around, whole **ends)
{
    whole *first = calloc(size + 2, sizeof(whole)), *sides = malloc((6 * count + 1) * sizeof(whole)), most = 0;
    *ends = first;
    *around = sides;
    if (!first || !sides) return -1;
    for (whole i = 0; i < 3 * count; i++) first[triangles[i] + 1]++;
    for (whole v = 0; v < size; v++) {
        if (first[v + 1] > most) most = first[v + 1];
        first[v + 1] += first[v];
    }
    for (whole t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) {
            whole *to = sides + 2 * first[triangles[3 * t + k]]++;
            to[0] = triangles[3 * t + (k + 1) % 3];
            to[1] = triangles[3 * t + (k + 2) % 3];
        }
    return most;
}

/* Into `kinds` (size) whether the vertices of triangles, or those `among` (size) if `some`, are in an edge without two
   triangles, or have more than one fan. */
int pas_fans(whole count, const whole *triangles, whole size, const char *among, whole some, char *kinds)
{
    whole *ends, *around;
    const whole most = sides_of(count, triangles, size, &around, &ends);
    char *seen = most < 0 ? NULL : malloc(most + 1);
    memset(kinds, FINE, size);
    for (whole v = 0, begin = 0; seen && v < size; begin = ends[v++])
        if (ends[v] > begin && (!some || among[v])) kinds[v] = kind_of(around + 2 * begin, ends[v] - begin, seen);
    const int state = seen ? 0 : -1;
    free(ends);
    free(around);
    free(seen);
    return state;
}

/* Whether all edges of triangles have one or two of them, and all vertices one fan. */
int pas_is_manifold(whole count, const whole *triangles, whole size, whole *manifold)
{
    whole *ends, *around;
    const whole most = sides_of(count, triangles, size, &around, &ends);
    char *seen = most < 0 ? NULL : malloc(most + 1);
    *manifold = 1;
    for (whole v = 0, begin = 0; seen && *manifold && v < size; begin = ends[v++])
        if (ends[v] > begin) *manifold = is_fan(around + 2 * begin, ends[v] - begin, seen);
    const int state = seen ? 0 : -1;
    free(ends);
    free(around);
    free(seen);
    return state;
}

static whole root_of(whole *parent, whole v)
{
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

/* How many connected pieces triangles have; `parent` (size) is room. */
int pas_pieces(whole count, const whole *triangles, whole size, whole *parent, whole *number)
{
    for (whole v = 0; v < size; v++) parent[v] = -1;
    for (whole i = 0; i < 3 * count; i++) parent[triangles[i]] = triangles[i];
    for (whole t = 0; t < count; t++)
        for (int k = 1; k < 3; k++) {
            const whole a = root_of(parent, triangles[3 * t]), b = root_of(parent, triangles[3 * t + k]);
            if (a != b) parent[a > b ? a : b] = a < b ? a : b;
        }
    *number = 0;
    for (whole v = 0; v < size; v++) *number += parent[v] == v;
    return 0;
}
