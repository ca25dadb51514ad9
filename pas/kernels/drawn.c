/* Points drawn towards a surface, with gradients and curvatures there, as in pas/surface/local_surface.py, and onto the
   curves on which it ends, for pas/surface/boundary_loops.py and local_field.py.

   Compiled together with forms.c and pas/algebra/horner.c.  A function that finds no memory returns -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "field.h"

#define BENDS 10

static inline double at_least(double value, double least) { return value < least ? least : value; }

/* The larger of the principal curvatures' sizes (count) by values and derivatives (BENDS, count). */
FAST
static void curvatures(whole count, const double *jets, double *bends)
{
    const double *gx = jets + count, *gy = gx + count, *gz = gy + count, *hxx = gz + count, *hxy = hxx + count;
    const double *hxz = hxy + count, *hyy = hxz + count, *hyz = hyy + count, *hzz = hyz + count;
    for (whole p = 0; p < count; p++) {
        const double xx = hxx[p], xy = hxy[p], xz = hxz[p], yy = hyy[p], yz = hyz[p], zz = hzz[p];
        const double length = at_least(sqrt(gx[p] * gx[p] + gy[p] * gy[p] + gz[p] * gz[p]), 1e-300);
        const double nx = gx[p] / length, ny = gy[p] / length, nz = gz[p] / length;
        const double x = xx * nx + xy * ny + xz * nz, y = xy * nx + yy * ny + yz * nz;
        const double z = xz * nx + yz * ny + zz * nz, along = nx * x + ny * y + nz * z;
        const double trace = xx + yy + zz - along;
        double square = xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz);
        square = square + (along * along - 2 * (x * x + y * y + z * z));
        bends[p] = (fabs(trace) + sqrt(at_least(2 * square - trace * trace, 0.0))) / (2 * length);
    }
}

static void transposed(whole count, const double *columns, double *rows)
{
    for (whole p = 0; p < count; p++)
        for (int i = 0; i < 3; i++) rows[3 * p + i] = columns[i * count + p];
}

/* The pieces (count) that points (count, 3) are in, or nearest to. */
int pas_pieces_of(const whole *sizes, const double *maps, const whole *piece_of, whole count, const double *points,
               whole *pieces)
{
    const Field field = {sizes, maps, piece_of, 0, 0, 0};
    double *room = malloc((count + 1) * sizeof(double));
    if (room) find_pieces(&field, count, points, room, pieces);
    free(room);
    return room ? 0 : -1;
}

/* Values (count), gradients (count, 3) and curvatures (count) at points (count, 3). */
int pas_bent(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
             const whole *starts, const double *tables, whole count, const double *points, double *values,
             double *gradients, double *bends)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *room = malloc((BENDS * count + 1) * sizeof(double));
    whole *piece = malloc((count + 1) * sizeof(whole));
    int state = room && piece ? 0 : -1;
    if (state == 0) state = values_at(&field, BENDS, count, points, room, piece, room);
    if (state == 0) {
        for (whole p = 0; p < count; p++) values[p] = room[p];
        transposed(count, room + count, gradients);
        curvatures(count, room, bends);
    }
    free(room);
    free(piece);
    return state;
}

/* Points moved by a step along the gradient (count, 3), gradients and curvatures there, and which were not near: of
   what is left of the way more than a share, whose square is `left`, and than a distance, whose square is `close`.  Points
   that are `still` stay. */
int pas_drawn(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
              const whole *starts, const double *tables, const whole *all_degrees, const whole *all_starts,
              const double *all_tables, whole count, const double *points, const char *still, double left, double close,
              double *moved, double *gradients, double *bends, char *lost)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *jets = malloc((JETS * count + 1) * sizeof(double)), *values = malloc((count + 1) * sizeof(double));
    whole *piece = malloc((count + 1) * sizeof(whole));
    int state = jets && values && piece ? 0 : -1;
    if (state == 0) state = values_at(&field, JETS, count, points, jets, piece, jets);
    if (state == 0) {
        for (whole p = 0; p < count; p++) {
            const double x = jets[count + p], y = jets[2 * count + p], z = jets[3 * count + p];
            const double share = -jets[p] / at_least(x * x + y * y + z * z, 1e-300);
            const double way[3] = {share * x, share * y, share * z};
            for (int i = 0; i < 3; i++) moved[3 * p + i] = still[p] ? points[3 * p + i] : points[3 * p + i] + way[i];
            jets[p] = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
        }
        state = pas_bent(sizes, maps, piece_of, all_degrees, all_starts, all_tables, count, moved, values,
                         gradients, bends);
    }
    for (whole p = 0; state == 0 && p < count; p++) {
        const double *g = gradients + 3 * p, square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        lost[p] = !still[p] && !(values[p] * values[p] <= (left * jets[p] + close) * square);
    }
    free(jets);
    free(values);
    free(piece);
    return state;
}

/* The distances (count) of points from the surface, to first order. */
int pas_distances(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
                  const whole *starts, const double *tables, whole count, const double *points, double *distances)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *jets = malloc((JETS * count + 1) * sizeof(double));
    whole *piece = malloc((count + 1) * sizeof(whole));
    int state = jets && piece ? 0 : -1;
    if (state == 0) state = values_at(&field, JETS, count, points, jets, piece, jets);
    for (whole p = 0; state == 0 && p < count; p++) {
        const double x = jets[count + p], y = jets[2 * count + p], z = jets[3 * count + p];
        distances[p] = fabs(jets[p]) / at_least(sqrt(x * x + y * y + z * z), 1e-300);
    }
    free(jets);
    free(piece);
    return state;
}

/* Points moved onto the surface along gradients in at most so many steps, the last one shorter than `close`, and the
   gradients there (count, 3). */
int pas_closed(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
               const whole *starts, const double *tables, whole count, whole steps, double close, double *points,
               double *gradients)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *jets = malloc((JETS * count + 1) * sizeof(double)), *places = malloc((3 * count + 1) * sizeof(double));
    whole *piece = malloc((2 * count + 1) * sizeof(whole)), *rows = piece + count, left = count;
    int state = jets && places && piece ? 0 : -1;
    for (whole p = 0; state == 0 && p < count; p++) rows[p] = p;
    for (whole step = 0; state == 0 && left && step < steps; step++) {
        state = jets_of(&field, left, rows, points, places, piece, jets);
        whole moving = 0;
        for (whole k = 0; state == 0 && k < left; k++) {
            const double g[3] = {jets[left + k], jets[2 * left + k], jets[3 * left + k]};
            const double square = at_least(g[0] * g[0] + g[1] * g[1] + g[2] * g[2], 1e-300);
            const whole p = rows[k];
            double largest = 0;
            for (int i = 0; i < 3; i++) {
                const double way = -jets[k] * g[i] / square;
                points[3 * p + i] += way;
                gradients[3 * p + i] = g[i];
                if (fabs(way) > largest) largest = fabs(way);
            }
            if (largest > close) rows[moving++] = p;
        }
        left = moving;
    }
    free(jets);
    free(places);
    free(piece);
    return state;
}

/* Where rays from the middles of curves of given numbers (count), in their planes, through points meet the curves. */
int pas_on_rings(whole rings, const whole *degrees, const whole *starts, const double *tables, const double *middles,
                 const double *normals, whole count, const double *points, const whole *numbers, whole steps,
                 double settled, double *result)
{
    double *way = malloc((11 * count + 1) * sizeof(double)), *share = way + 3 * count, *jets = share + count;
    double *places = jets + JETS * count;
    whole *rows = malloc((2 * count + 1) * sizeof(whole)), *own = rows + count, left = count;
    int state = way && rows ? 0 : -1;
    for (whole p = 0; state == 0 && p < count; p++) {
        const double *middle = middles + 3 * numbers[p], *normal = normals + 3 * numbers[p];
        double w[3];
        for (int i = 0; i < 3; i++) w[i] = points[3 * p + i] - middle[i];
        const double off = w[0] * normal[0] + w[1] * normal[1] + w[2] * normal[2];
        for (int i = 0; i < 3; i++) way[3 * p + i] = w[i] - off * normal[i];
        share[p] = 1.0;
        rows[p] = p;
    }
    for (whole step = 0; state == 0 && left && step < steps; step++) {
        for (whole k = 0; k < left; k++) {
            own[k] = numbers[rows[k]];
            for (int i = 0; i < 3; i++)
                places[3 * k + i] = middles[3 * own[k] + i] + share[rows[k]] * way[3 * rows[k] + i];
        }
        state = pas_mixed(rings, JETS, degrees, starts, tables, left, places, 3, 1, own, jets);
        whole moving = 0;
        for (whole k = 0; state == 0 && k < left; k++) {
            const double *w = way + 3 * rows[k], before = share[rows[k]];
            const double slope = jets[left + k] * w[0] + jets[2 * left + k] * w[1] + jets[3 * left + k] * w[2];
            double next = before * 2;
            if (slope > 0) {
                const double found = before - jets[k] / slope, most = next;
                next = found < before / 2 ? before / 2 : found;
                next = next > most ? most : next;
            }
            share[rows[k]] = next;
            if (!(fabs(next - before) < settled)) rows[moving++] = rows[k];
        }
        left = moving;
    }
    for (whole p = 0; state == 0 && p < count; p++)
        for (int i = 0; i < 3; i++) result[3 * p + i] = middles[3 * numbers[p] + i] + share[p] * way[3 * p + i];
    free(way);
    free(rows);
    return state;
}

/* A point moved onto two planes (unit normals and offsets) by the ways `back` onto them. */
static void onto(const double *planes, const double *back, double *point)
{
    double off[2];
    for (int k = 0; k < 2; k++) {
        const double *plane = planes + 4 * k;
        off[k] = point[0] * plane[0] + point[1] * plane[1] + point[2] * plane[2] - plane[3];
    }
    for (int i = 0; i < 3; i++) point[i] = point[i] - off[0] * back[i] - off[1] * back[3 + i];
}

/* Points (count, 3) moved onto the surface along gradients, steps being no longer than `farthest`; where there are walls
   in planes (walls, 2, 4), those of given numbers (count) onto these and at right angles to `across` (walls, 2, 3). */
int pas_slid(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
             const whole *starts, const double *tables, whole walls, const double *planes, const double *across,
             const double *back, const whole *numbers, whole steps, double settled, double farthest, whole count,
             double *points)
{
    const Field field = {sizes, maps, piece_of, degrees, starts, tables};
    double *jets = malloc((JETS * count + 1) * sizeof(double)), *places = malloc((3 * count + 1) * sizeof(double));
    whole *piece = malloc((2 * count + 1) * sizeof(whole)), *rows = piece + count, left = count;
    int state = jets && places && piece ? 0 : -1;
    for (whole p = 0; state == 0 && p < count; p++) {
        rows[p] = p;
        if (walls) onto(planes + 8 * numbers[p], back + 6 * numbers[p], points + 3 * p);
    }
    for (whole step = 0; state == 0 && left && step < steps; step++) {
        state = jets_of(&field, left, rows, points, places, piece, jets);
        whole moving = 0;
        for (whole k = 0; state == 0 && k < left; k++) {
            const whole p = rows[k];
            double g[3] = {jets[left + k], jets[2 * left + k], jets[3 * left + k]};
            for (int j = 0; walls && j < 2; j++) {
                const double *way = across + 6 * numbers[p] + 3 * j;
                const double along = g[0] * way[0] + g[1] * way[1] + g[2] * way[2];
                for (int i = 0; i < 3; i++) g[i] = g[i] - along * way[i];
            }
            const double square = at_least(g[0] * g[0] + g[1] * g[1] + g[2] * g[2], 1e-300);
            for (int i = 0; i < 3; i++) g[i] = -jets[k] * g[i] / square;
            const double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
            double share = farthest / at_least(length, 1e-300);
            share = share > 1.0 ? 1.0 : share;
            for (int i = 0; i < 3; i++) points[3 * p + i] += g[i] * share;
            if (length > settled) rows[moving++] = p;
        }
        left = moving;
    }
    for (whole p = 0; state == 0 && walls && p < count; p++)
        for (int times = 0; times < 2; times++)
            onto(planes + 8 * numbers[p], back + 6 * numbers[p], points + 3 * p);
    free(jets);
    free(places);
    free(piece);
    return state;
}
