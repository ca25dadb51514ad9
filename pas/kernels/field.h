/* A surface of several polynomials, each in cells between its centre and faces; see pas/surface/patch_field.py. */

#ifndef PAS_FIELD_H
#define PAS_FIELD_H

#include "kernel.h"

#define JETS 4 /* value and gradient */

/* Faces by their weights, each of a piece, and some polynomials of each piece; one piece without faces. */
typedef struct {
    whole faces;
    const double *weights;
    const whole *piece_of;
    whole pieces;
    const whole *degrees, *starts;
    const double *tables;
} Field;

/* Values (polynomials, count) at points in `pieces`, and the multiples of these (count) at which their rays leave, which
   may stand where the values come. */
static inline int values_at(const Field *field, whole polynomials, whole count, const double *points, double *leave,
                            whole *pieces, double *values)
{
    if (field->faces) pas_leaving(field->faces, field->weights, count, points, leave, pieces);
    for (whole p = 0; p < count; p++) pieces[p] = field->faces ? field->piece_of[pieces[p]] : 0;
    return pas_mixed(field->pieces, polynomials, field->degrees, field->starts, field->tables, count, points, pieces,
                     values);
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
