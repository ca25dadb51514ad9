/* Where rays from the centre of a region, or from its skeleton, meet a surface: see pas/surface/radial_field.py.

   Compiled together with forms.c and pas/algebra/horner.c.  A function that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "field.h"

#define BLOCK 64

static double dot(const double *u, const double *v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* The multiple of a point at which the profile along its ray, whose coefficients are `stride` apart, is 0. */
static double root_along(whole degree, const double *profile, whole stride, double leave, whole steps, double settled)
{
    double low = 0, high = leave, share = 0.5 * (low + high) + 0.5 * (high > 1.0);
    share = share > 1.0 ? 1.0 : share;
    for (whole step = 0; step < steps; step++) {
        double value = profile[degree * stride], slope = 0;
        for (whole k = degree - 1; k >= 0; k--) {
            slope = slope * share + value;
            value = value * share + profile[k * stride];
        }
        if (value < 0) low = share;
        else high = share;
        double next = share - value / slope;
        if (!(next >= low && next <= high && slope > 0)) next = (low + high) / 2;
        const int moves = fabs(next - share) > settled * next;
        share = next;
        if (!moves) break;
    }
    return share;
}

/* Points (count, 3) moved along rays from 0 to where these meet the surface, whose polynomials are given by the parts of
   each degree. */
static int met(const whole *sizes, const double *maps, const whole *piece_of, whole parts, const whole *degrees,
               const whole *starts, const double *tables, whole count, const double *points, whole steps, double settled,
               double *result)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *profiles = malloc((parts * count + 1) * sizeof(double)), *leave = malloc((count + 1) * sizeof(double));
    whole *own = malloc((count + 1) * sizeof(whole));
    int state = profiles && leave && own ? 0 : -1;
    if (state == 0) state = values_at(&field, parts, count, points, leave, own, profiles);
    for (whole p = 0; state == 0 && p < count; p++) {
        const double share = root_along(parts - 1, profiles + p, count, leave[p], steps, settled);
        for (int i = 0; i < 3; i++) result[3 * p + i] = points[3 * p + i] * share;
    }
    free(profiles);
    free(leave);
    free(own);
    return state;
}

/* The nearest point of the skeleton, which joins 0 with the middles of curves. */
static void foot_of(whole rings, const double *middles, const double *squares, const double *point, double *foot)
{
    double least = dot(point, point);
    for (int i = 0; i < 3; i++) foot[i] = 0;
    for (whole r = 0; r < rings; r++) {
        const double *middle = middles + 3 * r;
        double along = dot(point, middle) / squares[r], place[3], way[3];
        along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
        for (int i = 0; i < 3; i++) {
            place[i] = along * middle[i];
            way[i] = point[i] - place[i];
        }
        const double square = dot(way, way);
        if (!(square < least)) continue;
        least = square;
        for (int i = 0; i < 3; i++) foot[i] = place[i];
    }
}

/* Points (count, 3) moved along rays from the nearest points of the skeleton; those that do not meet the surface nearby
   are put where the `result` is before.  Steps outwards are at most `most` times the way there, and rays are followed
   over at most a distance from the skeleton whose square is `away`. */
int pas_around(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
               const whole *starts, const double *tables, whole rings, const double *middles, const double *squares,
               whole count, const double *points, whole steps, double settled, double most, double away, double *result)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *feet = malloc(((9 + 4 + JETS) * count + 1) * sizeof(double)), *ways = feet + 3 * count;
    double *places = ways + 3 * count, *low = places + 3 * count, *high = low + count, *share = high + count;
    double *leave = share + count, *jets = leave + count;
    whole *own = malloc((2 * count + 1) * sizeof(whole)), *rows = own + count, left = count;
    int state = feet && own ? 0 : -1;
    for (whole p = 0; state == 0 && p < count; p++) {
        foot_of(rings, middles, squares, points + 3 * p, feet + 3 * p);
        for (int i = 0; i < 3; i++) ways[3 * p + i] = points[3 * p + i] - feet[3 * p + i];
        low[p] = 0;
        high[p] = INFINITY;
        share[p] = 1.0;
        rows[p] = p;
    }
    for (whole step = 0; state == 0 && left && step < steps; step++) {
        for (whole k = 0; k < left; k++)
            for (int i = 0; i < 3; i++)
                places[3 * k + i] = feet[3 * rows[k] + i] + share[rows[k]] * ways[3 * rows[k] + i];
        state = values_at(&field, JETS, left, places, leave, own, jets);
        whole moving = 0;
        for (whole k = 0; state == 0 && k < left; k++) {
            const whole p = rows[k];
            const double g[3] = {jets[left + k], jets[2 * left + k], jets[3 * left + k]};
            const double value = jets[k], slope = dot(g, ways + 3 * p), before = share[p];
            if (value < 0) low[p] = before;
            else high[p] = before;
            const double furthest = high[p] < most * before ? high[p] : most * before;
            double next = before - value / slope;
            if (!(next >= low[p] && next <= furthest && slope > 0))
                next = isfinite(high[p]) ? (low[p] + high[p]) / 2 : furthest;
            share[p] = next;
            if (fabs(next - before) > settled * next) rows[moving++] = p;
        }
        left = moving;
    }
    for (whole p = 0; state == 0 && p < count; p++) {
        double found[3], way[3];
        for (int i = 0; i < 3; i++) {
            found[i] = feet[3 * p + i] + share[p] * ways[3 * p + i];
            way[i] = found[i] - points[3 * p + i];
        }
        if (dot(way, way) <= away * dot(ways + 3 * p, ways + 3 * p))
            for (int i = 0; i < 3; i++) result[3 * p + i] = found[i];
    }
    free(feet);
    free(own);
    return state;
}

/* Points (count, 3) moved along rays from 0, and which of them are on rays at a cosine with the surface's normal of at
   most `steep`, or further from the surface than a share `off` of their way; the first polynomials are the parts of each
   degree, the others values and gradients. */
int pas_near(const whole *sizes, const double *maps, const whole *piece_of, whole parts, const whole *degrees,
             const whole *starts, const double *tables, const whole *all_degrees, const whole *all_starts,
             const double *all_tables, whole count, const double *points, whole steps, double settled, double steep,
             double off, double *result, char *grazed)
{
    const Field field = {sizes, maps, piece_of, all_degrees, all_starts, all_tables};
    double *jets = malloc((JETS * count + 1) * sizeof(double)), *leave = malloc((count + 1) * sizeof(double));
    whole *own = malloc((count + 1) * sizeof(whole));
    int state = jets && leave && own ? 0 : -1;
    if (state == 0)
        state = met(sizes, maps, piece_of, parts, degrees, starts, tables, count, points, steps, settled, result);
    if (state == 0) state = values_at(&field, JETS, count, result, leave, own, jets);
    for (whole p = 0; state == 0 && p < count; p++) {
        const double g[3] = {jets[count + p], jets[2 * count + p], jets[3 * count + p]}, *place = result + 3 * p;
        const double size = sqrt(dot(place, place) * dot(g, g));
        grazed[p] = !(dot(place, g) > steep * size && fabs(jets[p]) <= off * size);
    }
    free(jets);
    free(leave);
    free(own);
    return state;
}

/* Whether profiles (parts, count) change their sign once, from below 0, at the shares (samples) of where rays leave. */
FAST
int pas_once(whole parts, whole count, const double *profiles, const double *leave, whole samples, const double *shares,
             whole *once)
{
    *once = 1;
    for (whole p = 0; *once && p < count; p++)
        for (whole start = 0, inside = 1; start < samples; start += BLOCK) {
            const whole size = samples - start < BLOCK ? samples - start : BLOCK;
            double at[BLOCK], values[BLOCK];
            for (whole k = 0; k < size; k++) {
                at[k] = shares[start + k] * leave[p];
                values[k] = 0;
            }
            for (whole i = parts - 1; i >= 0; i--)
                for (whole k = 0; k < size; k++) values[k] = values[k] * at[k] + profiles[i * count + p];
            *once &= start > 0 || values[0] < 0;
            *once &= start + size < samples || !(values[size - 1] < 0);
            for (whole k = 0; k < size; k++) {
                *once &= inside || !(values[k] < 0);
                inside = values[k] < 0;
            }
        }
    return 0;
}
