/* How often segments cross an oriented mesh: see pas/certify/graph_proofs.py.  Only triangles are looked at whose directions
   from the origin are in a cone with that of the end. */

#include <math.h>
#include <stddef.h>

#include "pas.h"
#include "vectors.h"

static inline double determinant(const double *a, const double *b, const double *c, double product, double *error,
                                 double sure)
{
    double w[3];
    cross(b, c, w);
    *error = sure * sqrt(product);
    return dot(a, w);
}

/* 1, -1 or 0 for a segment from 0 along `way`, squared length `length`, and a triangle; whether that is sure. */
static int sign_of(const double *way, double length, double corners[3][3], const double *lengths, double sure,
                   int *known)
{
    double side[3], error[3], wrong, total = 0, errors = 0;
    int up = 0, down = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        side[i] = determinant(way, corners[i], corners[j], length * lengths[i] * lengths[j], error + i, sure);
        up += side[i] > error[i];
        down += side[i] < -error[i];
        total = i ? total + side[i] : side[i];
        errors = i ? errors + error[i] : error[i];
    }
    const double product = lengths[0] * lengths[1] * lengths[2];
    const int sign = down == 3 ? -1 : 1, all = up == 3 || down == 3;
    const double whole_of = sign * determinant(corners[0], corners[1], corners[2], product, &wrong, sure);
    total *= sign;
    const int hit = all && whole_of > wrong && total - whole_of > wrong + errors;
    *known = hit || (up && down) || (all && (whole_of < -wrong || whole_of - total > wrong + errors));
    return hit ? sign : 0;
}

/* Into `times` and `known` (ends) what segments from `origin` along `ways` (ends, 3), unit vectors `towards`, come to. */
int pas_crossed(whole count, const whole *triangles, const double *points, const double *origin, whole ends,
                const double *ways, const double *towards, double grazing, double sure, whole *times, char *known)
{
    for (whole e = 0; e < ends; e++) {
        times[e] = 0;
        known[e] = 1;
    }
    for (whole t = 0; t < count; t++) {
        double corners[3][3], units[3][3], lengths[3], middle[3];
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 3; i++) corners[k][i] = points[3 * triangles[3 * t + k] + i] - origin[i];
            lengths[k] = dot(corners[k], corners[k]);
            const double length = larger(sqrt(lengths[k]), 1e-300);
            for (int i = 0; i < 3; i++) units[k][i] = corners[k][i] / length;
        }
        for (int i = 0; i < 3; i++) middle[i] = units[0][i] + units[1][i] + units[2][i];
        const double size = larger(sqrt(dot(middle, middle)), 1e-300);
        for (int i = 0; i < 3; i++) middle[i] /= size;
        double cap = dot(units[0], middle);
        for (int k = 1; k < 3; k++) cap = smaller(dot(units[k], middle), cap);
        cap = (cap > 0 ? cap : -1.0) - grazing;
        for (whole e = 0; e < ends; e++) {
            if (!(dot(towards + 3 * e, middle) >= cap)) continue;
            int certain;
            times[e] += sign_of(ways + 3 * e, dot(ways + 3 * e, ways + 3 * e), corners, lengths, sure, &certain);
            if (!certain) known[e] = 0;
        }
    }
    return 0;
}
