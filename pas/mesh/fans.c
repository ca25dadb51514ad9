/* Whether the triangles around vertices are one closed fan, as in pas/mesh/topology.py.  A function that finds no memory
   returns -1. */

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef ptrdiff_t whole;

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

/* Into `kinds` (size) whether the vertices of triangles, or those `among` (size) if `some`, are in an edge without two
   triangles, or have more than one fan. */
int pas_fans(whole count, const whole *triangles, whole size, const char *among, whole some, char *kinds)
{
    whole *first = calloc(size + 2, sizeof(whole)), *around = malloc((6 * count + 1) * sizeof(whole)), most = 0;
    char *seen = NULL;
    int state = first && around ? 0 : -1;
    memset(kinds, FINE, size);
    if (state == 0) {
        for (whole i = 0; i < 3 * count; i++) first[triangles[i] + 1]++;
        for (whole v = 0; v < size; v++) {
            if (first[v + 1] > most) most = first[v + 1];
            first[v + 1] += first[v];
        }
        for (whole t = 0; t < count; t++)
            for (int k = 0; k < 3; k++) {
                whole *to = around + 2 * first[triangles[3 * t + k]]++;
                to[0] = triangles[3 * t + (k + 1) % 3];
                to[1] = triangles[3 * t + (k + 2) % 3];
            }
        seen = malloc(most + 1);
        if (!seen) state = -1;
    }
    for (whole v = 0, begin = 0; state == 0 && v < size; begin = first[v++]) /* `first` now says where those of v end */
        if (first[v] > begin && (!some || among[v])) kinds[v] = kind_of(around + 2 * begin, first[v] - begin, seen);
    free(first);
    free(around);
    free(seen);
    return state;
}
