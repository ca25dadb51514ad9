/* Vectors of three doubles, with sums and products in the order of pas/mesh/rows.py; and the larger and the smaller of two
   numbers, the second where one is none. */

#ifndef PAS_VECTORS_H
#define PAS_VECTORS_H

static inline double larger(double a, double b) { return a > b ? a : b; }

static inline double smaller(double a, double b) { return a < b ? a : b; }

static inline double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static inline void minus(const double *u, const double *v, double *w)
{
    for (int i = 0; i < 3; i++) w[i] = u[i] - v[i];
}

static inline void cross(const double *u, const double *v, double *w)
{
    w[0] = u[1] * v[2] - u[2] * v[1];
    w[1] = u[2] * v[0] - u[0] * v[2];
    w[2] = u[0] * v[1] - u[1] * v[0];
}

#endif
