/* A surface of several polynomials in local coordinates, and how the piece of a point is found; see
   pas/surface/local_surface.py. */

#ifndef PAS_FIELD_H
#define PAS_FIELD_H

#include "kernel.h"

#define JETS 4 /* value and gradient */

/* Of `sizes` the first says how many pieces there are, the second how many outer faces, through which rays from 0 leave,
   the third how many cells; of these there are faces by their weights (faces, 3, 3), or cells by their barycentric maps
   (cells, 4, 4), each of a piece, or none where there is one piece.  Then come some polynomials of each piece. */
typedef struct {
    const whole *sizes;
    const double *maps;
    const whole *piece_of, *degrees, *starts;
    const double *tables;
} Field;

/* The pieces of points, and, where there are faces, the multiples of these (count) at which their rays leave. */
static inline void find_pieces(const Field *field, whole count, const double *points, double *leave, whole *pieces)
{
    const whole faces = field->sizes[1], cells = field->sizes[2];
    if (faces) pas_leaving(faces, field->maps, count, points, leave, pieces);
    else if (cells) pas_deepest(cells, field->maps, count, points, pieces);
    for (whole p = 0; p < count; p++) pieces[p] = faces || cells ? field->piece_of[pieces[p]] : 0;
}

/* Values (polynomials, count) at points in `pieces`, and, where there are faces, the multiples of these (count) at which
   their rays leave, which may stand where the values come. */
static inline int values_at(const Field *field, whole polynomials, whole count, const double *points, double *leave,
                            whole *pieces, double *values)
{
    find_pieces(field, count, points, leave, pieces);
    return pas_mixed(field->sizes[0], polynomials, field->degrees, field->starts, field->tables, count, points, 3, 1,
                     pieces, values);
}

/* Values and gradients (JETS, count) at some of the points, by their numbers. */
static inline int jets_of(const Field *field, whole count, const whole *numbers, const double *points, double *places,
                          whole *pieces, double *jets)
{
    for (whole k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) places[3 * k + i] = points[3 * numbers[k] + i];
    return values_at(field, JETS, count, places, jets, pieces, jets);
}

#endif
