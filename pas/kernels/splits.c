/* Edges of triangles found among others: those that are too long, and those that are split, as in pas/mesh/graded.py and
   refine.py.  A function that finds no memory returns -1. */

#include <stddef.h>
#include <stdlib.h>

#include "pas.h"

static whole place_of(const whole *keys, whole count, whole key)
{
    whole low = 0, high = count;
    while (low < high) {
        const whole middle = (low + high) / 2;
        if (keys[middle] < key) low = middle + 1;
        else high = middle;
    }
    return low < count && keys[low] == key ? low : -1;
}

/* Into `marks` (count, 3) where the sides of triangles stand among sorted keys of edges, -1 for those that are not
   there; how many triangles have none, one, two and three into `numbers` (4).  Only vertices `ends` (size) have such. */
int pas_marked(whole count, const whole *triangles, whole size, const char *ends, whole edges, const whole *keys,
               whole *marks, whole *numbers)
{
    for (int n = 0; n < 4; n++) numbers[n] = 0;
    for (whole t = 0; t < count; t++) {
        int found = 0;
        for (int k = 0; k < 3; k++) {
            const whole a = triangles[3 * t + k], b = triangles[3 * t + (k + 1) % 3];
            whole *mark = marks + 3 * t + k;
            *mark = ends[a] && ends[b] ? place_of(keys, edges, a < b ? a * size + b : b * size + a) : -1;
            found += *mark >= 0;
        }
        numbers[found]++;
    }
    return 0;
}

/* The triangles and of which each is part: those without marks, then the two parts of those with one, the three of those
   with two, and the four of those with three, all first parts before all second ones and so on. */
int pas_split(whole count, const whole *triangles, whole size, const whole *marks, const whole *numbers, whole *parts,
              whole *parents)
{
    /* corners of the parts: 0 to 2 of the triangle, 3 to 5 on its sides, turned */
    static const int corners[4][4][3] = {{{0, 1, 2}},
                                         {{0, 3, 2}, {3, 1, 2}},
                                         {{3, 1, 4}, {0, 3, 4}, {0, 4, 2}},
                                         {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
    whole starts[4] = {0}, done[4] = {0};
    for (int n = 1; n < 4; n++) starts[n] = starts[n - 1] + n * numbers[n - 1];
    for (whole t = 0; t < count; t++) {
        const whole *mark = marks + 3 * t;
        const int number = (mark[0] >= 0) + (mark[1] >= 0) + (mark[2] >= 0);
        int turn = 0;
        if (number == 1)
            while (mark[turn] < 0) turn++;
        if (number == 2) {
            while (mark[turn] >= 0) turn++;
            turn++; /* the side that is not split is the last */
        }
        whole at[6];
        for (int k = 0; k < 3; k++) {
            at[k] = triangles[3 * t + (turn + k) % 3];
            at[3 + k] = mark[(turn + k) % 3] + size;
        }
        for (int part = 0; part < (number ? number + 1 : 1); part++) {
            const whole row = starts[number] + part * numbers[number] + done[number];
            for (int k = 0; k < 3; k++) parts[3 * row + k] = at[corners[number][part][k]];
            parents[row] = t;
        }
        done[number]++;
    }
    return 0;
}
