/* Where rays cross a piecewise polynomial's zeros, ray by ray; see pas/surface/crossings.py for what counts, and
   pas/surface/rays.py for the cells, the Bernstein forms and the bounds on their rounding.

   What doubles cannot decide of a ray is marked, to be worked out exactly.  A function that finds no memory returns
   -1. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define MOST 32    /* the highest degree but one */
#define LANES 8    /* points at once */
#define WIDE 4     /* of them in a register: of wider ones compilers make none where the machine has none */
#define DEEPEST 40 /* halvings of a part */
#define STEPS 60   /* of Newton's method */
#define CLOSE 1e-6 /* a step over the part, or over the way: the next, on the polynomial itself, is about its square */
#define UNDECIDED 4.0
#define UNIT 0x1p-53
#define MARGIN 0.125
#define ROUNDINGS 8 /* of numbers on a ray, by which a point may be off */

/* Numbers that the compiler keeps in as few registers as the machine lets it. */
typedef double Lanes __attribute__((vector_size(WIDE * sizeof(double))));

/* Horner's rule as in pas/algebra/horner.c, at LANES points. */
FAST
static void at_points(whole n, const double *c, const Lanes (*points)[2], double *values)
{
    const Lanes x = points[0][0], y = points[1][0], z = points[2][0], none = {0};
    const Lanes u = points[0][1], v = points[1][1], w = points[2][1];
    Lanes f = none, g = none, h, p = none, q = none, r;
    for (whole i = 0; i <= n; i++) {
        for (whole j = 0; j <= i; j++) {
            h = r = *c++ - none; /* all of them the coefficient */
            for (whole k = 1; k <= j; k++, c++) {
                h = h * z + *c;
                r = r * w + *c;
            }
            g = j == 0 ? h : g * y + h;
            q = j == 0 ? r : q * v + r;
        }
        f = i == 0 ? g : f * x + g;
        p = i == 0 ? q : p * u + q;
    }
    memcpy(values, &f, sizeof f);
    memcpy(values + WIDE, &p, sizeof p);
}

/* The same for four polynomials of one degree at one point; their coefficients stand side by side. */
FAST
static void four_at(whole n, const double *c, double x, double y, double z, double *values)
{
    double f[4] = {0}, g[4] = {0}, h[4];
    for (whole i = 0; i <= n; i++) {
        for (whole j = 0; j <= i; j++) {
            for (int r = 0; r < 4; r++) h[r] = c[r];
            c += 4;
            for (whole k = 1; k <= j; k++, c += 4)
                for (int r = 0; r < 4; r++) h[r] = h[r] * z + c[r];
            for (int r = 0; r < 4; r++) g[r] = j == 0 ? h[r] : g[r] * y + h[r];
        }
        for (int r = 0; r < 4; r++) f[r] = i == 0 ? g[r] : f[r] * x + g[r];
    }
    for (int r = 0; r < 4; r++) values[r] = f[r];
}

typedef struct {
    double enter, first, last, leave; /* at most from enter to leave, certainly from first to last */
    double length;                    /* leave - enter; of an endless one the t - enter of the share 1/2 */
    whole cell;
} Span;

typedef struct {
    whole cells, degree;
    const double *maps;   /* (4, 4, cells): of each barycentric coordinate the factors of x, y, z and the constant */
    const double *widths; /* (4, cells): by how much they may be off */
    const double *clear;  /* of each cell: closer to 0 its polynomial has no zero */
    const whole *piece_of;
    const double *tables, *sizes, *jets; /* of each piece, with signs, without, and with derivatives side by side */
    Lanes nodes[MOST / WIDE], to_bernstein[MOST][MOST / WIDE]; /* of each value its share in the coefficients */
    double binomials[MOST][MOST];
    const double *largest; /* the sizes of polynomials at coordinates as large as `farthest` */
    double growth, reach, farthest;
    double *bounds; /* (4, cells): where a ray enters and leaves them, at most and then certainly */
    Span *spans;
} Scene;

/* Where a ray is in each cell, at most or certainly: for lines raised (sign 1) or lowered (-1) by their widths. */
FAST
static void cross_cells(const Scene *s, const double *o, const double *d, double longest, double wide, double sign,
                        double *enter, double *leave)
{
    const whole cells = s->cells;
    for (whole c = 0; c < cells; c++) {
        enter[c] = 0;
        leave[c] = longest;
    }
    for (int k = 0; k < 4; k++) {
        const double *a = s->maps + 4 * k * cells, *b = a + cells, *e = b + cells, *f = e + cells;
        const double *width = s->widths + k * cells;
        for (whole c = 0; c < cells; c++) {
            const double at = a[c] * o[0] + b[c] * o[1] + e[c] * o[2] + f[c] + sign * width[c] * wide;
            const double slope = a[c] * d[0] + b[c] * d[1] + e[c] * d[2] + sign * width[c];
            const double met = -at / slope;
            const double in = slope > 0 ? met : (slope == 0 && at < 0) ? INFINITY : 0;
            const double out = slope < 0 ? met : longest;
            enter[c] = in > enter[c] ? in : enter[c];
            leave[c] = out < leave[c] ? out : leave[c];
        }
    }
}

/* The stretches of a ray in cells, by where it enters them, or in all of space where there are none; how many. */
static whole stretches(const Scene *s, const double *o, const double *d)
{
    const whole cells = s->cells;
    double *enter = s->bounds, *leave = enter + cells, *first = leave + cells, *last = first + cells, size = 0;
    whole count = 0;
    for (int i = 0; i < 3; i++) size = fabs(o[i]) > size ? fabs(o[i]) : size;
    if (!cells) {
        double most = 0;
        for (int i = 0; i < 3; i++) most = fabs(d[i]) > most ? fabs(d[i]) : most;
        s->spans[0] = (Span){0, 0, INFINITY, INFINITY, (1 + size) / most, 0};
        return 1;
    }
    const double longest = 2 * (size + s->farthest), wide = 1 + size + s->reach;
    cross_cells(s, o, d, longest, wide, 1, enter, leave);
    cross_cells(s, o, d, longest, wide, -1, first, last);
    for (whole c = 0; c < cells; c++) {
        if (leave[c] < enter[c] || size + leave[c] <= s->clear[c]) continue;
        whole i = count++;
        for (; i > 0 && s->spans[i - 1].enter > enter[c]; i--) s->spans[i] = s->spans[i - 1];
        s->spans[i] = (Span){enter[c], first[c], last[c], leave[c], leave[c] - enter[c], c};
    }
    return count;
}

/* Where the ray is at a share of a stretch. */
static double at_share(const Scene *s, const Span *span, double share)
{
    return span->enter + (s->cells ? share : share / (1 - share)) * span->length;
}

/* The Bernstein form on a stretch; on an endless one that of (1 - share)^n f. */
FAST
static void form_on(const Scene *s, const Span *span, const double *o, const double *d, double *form)
{
    const whole n = s->degree, piece = s->piece_of[span->cell];
    const double *table = s->tables + piece * ((n + 1) * (n + 2) * (n + 3) / 6);
    double values[MOST];
    for (whole part = 0; part * LANES <= n; part++) {
        const Lanes t = span->enter + s->nodes[2 * part] * span->length;
        const Lanes u = span->enter + s->nodes[2 * part + 1] * span->length;
        const Lanes points[3][2] = {{o[0] + t * d[0], o[0] + u * d[0]},
                                    {o[1] + t * d[1], o[1] + u * d[1]},
                                    {o[2] + t * d[2], o[2] + u * d[2]}};
        at_points(n, table, points, values + part * LANES);
    }
    for (whole part = 0; part * WIDE <= n; part++) {
        Lanes total = {0};
        for (whole k = 0; k <= n; k++) total += s->to_bernstein[k][part] * values[k];
        memcpy(form + part * WIDE, &total, sizeof total);
    }
}

/* By how much its coefficients may be off: by the polynomial's size there, or, where not `close`, in the cells.

   With P the polynomial with coefficients |c|, Horner's rule errs by at most g P(|x|), where g = (2n + 8) UNIT: the
   last 2 are for the coefficients' own rounding and that of the nodes; what underflows is made up for by adding to
   coefficients.  A point that is off by d <= h changes the value by at most d P(|x| + h) / h, since P is convex and
   grows; here h is half of MARGIN, and the other half is for |x| itself.  For larger d the bound is above P and so above
   all forms, which decides nothing.  A point is off by at most ROUNDINGS of |origin| + t |way| + |the region's place|:
   two of the local origin, and of t |way| four in t and two in product and sum.  On endless stretches the points'
   roundings are relative to what Horner's rule multiplies, and add 7n to g with those of the powers of 1 - share;
   (1 - share)^n P(|x|) is at most P(|o| + length |d|). */
static double error_on(const Scene *s, const Span *span, const double *o, const double *d, int close)
{
    const whole n = s->degree, piece = s->piece_of[span->cell], count = (n + 1) * (n + 2) * (n + 3) / 6;
    double far[3], off = 0, size = s->largest[piece];
    int within = s->cells > 0;
    for (int i = 0; i < 3; i++) {
        if (!s->cells) {
            far[i] = fabs(o[i]) + span->length * fabs(d[i]);
            continue;
        }
        const double begin = fabs(o[i] + span->enter * d[i]), end = fabs(o[i] + span->leave * d[i]);
        const double wide = s->reach + fabs(o[i]) + span->leave * fabs(d[i]);
        far[i] = (begin > end ? begin : end) + MARGIN;
        off = wide > off ? wide : off;
        within &= far[i] <= s->farthest;
    }
    if (close || !within) {
        const Lanes none = {0}, x = far[0] - none, y = far[1] - none, z = far[2] - none;
        const Lanes points[3][2] = {{x, x}, {y, y}, {z, z}};
        double values[LANES];
        at_points(n, s->sizes + piece * count, points, values);
        size = values[0];
    }
    if (!s->cells) return s->growth * ((9 * n + 8) * UNIT) * size;
    return s->growth * ((2 * n + 8) * UNIT + 2 * ROUNDINGS * UNIT * off / MARGIN) * size;
}

static double bernstein_at(whole n, const double *times, const double *form, double t)
{
    const double rest = 1 - t;
    double power = 1, result = form[0];
    for (whole i = 1; i <= n; i++) {
        power *= t;
        result = result * rest + times[i] * power * form[i];
    }
    return result;
}

/* The root in [0, 1] of a monotone form whose ends differ in sign. */
static double root_of(const Scene *s, const double *form)
{
    const whole n = s->degree;
    double slopes[MOST], low = 0, high = 1, share = form[0] / (form[0] - form[n]);
    const int falling = form[0] >= 0;
    for (whole i = 0; i < n; i++) slopes[i] = n * (form[i + 1] - form[i]);
    for (int step = 0; step < STEPS; step++) {
        const double value = bernstein_at(n, s->binomials[n], form, share);
        if ((value >= 0) == falling) low = share;
        else high = share;
        double after = share - value / bernstein_at(n - 1, s->binomials[n - 1], slopes, share);
        if (!(after >= low && after <= high)) after = (low + high) / 2;
        const double way = fabs(after - share);
        share = after;
        if (!(way > CLOSE)) break;
    }
    return share;
}

/* Newton's method on the polynomial itself, within the part, and within the cell: one step but where the form's rounding
   has spoilt the root, which may be far away on an endless stretch. */
static double polished(const Scene *s, const Span *span, const double *o, const double *d, double low, double width,
                       double share, int rising)
{
    const whole n = s->degree, count = (n + 1) * (n + 2) * (n + 3) / 6;
    const double *jets = s->jets + 4 * count * s->piece_of[span->cell];
    const double begin = at_share(s, span, low), end = at_share(s, span, low + width);
    double better = at_share(s, span, low + width * share), jet[4];
    for (int step = 0; step < STEPS; step++) {
        const double t = better;
        four_at(n, jets, o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2], jet);
        const double slope = jet[1] * d[0] + jet[2] * d[1] + jet[3] * d[2];
        better = t - jet[0] / slope;
        if (!isfinite(better) || (slope > 0) != rising) better = t;
        better = better < begin ? begin : better > end ? end : better;
        if (!(fabs(better - t) > CLOSE * (t + span->length))) break;
    }
    return better < span->first ? span->first : better > span->last ? span->last : better;
}

typedef struct {
    double low, width, error, form[MOST];
} Part;

typedef struct {
    whole room, number, ray, *rays, *sides;
    double *parameters;
} Found;

/* Crossings for which there is no room are counted all the same. */
static void note(Found *found, double parameter, int side)
{
    if (found->number < found->room) {
        found->rays[found->number] = found->ray;
        found->parameters[found->number] = parameter;
        found->sides[found->number] = side;
    }
    found->number++;
}

static double largest_of(whole n, const double *form)
{
    double result = 0;
    for (whole i = 0; i <= n; i++) result = fabs(form[i]) > result ? fabs(form[i]) : result;
    return result;
}

/* What is on a part: 0 no root, 1 one, 2 it is to be halved, 3 it cannot be decided. */
static int look(whole n, const double *form, double error)
{
    double low = form[0], high = form[0], least = INFINITY, most = -INFINITY;
    for (whole i = 1; i <= n; i++) {
        const double slope = form[i] - form[i - 1];
        low = form[i] < low ? form[i] : low;
        high = form[i] > high ? form[i] : high;
        least = slope < least ? slope : least;
        most = slope > most ? slope : most;
    }
    if (!(low <= error && high >= -error)) return 0;
    if (least > 2 * error || most < -2 * error) return (form[0] < 0) != (form[n] < 0);
    return (-low > high ? -low : high) <= UNDECIDED * error ? 3 : 2;
}

/* The crossings on a stretch: 1 where it cannot be decided. */
static int on_stretch(const Scene *s, const Span *span, const double *o, const double *d, const double *form,
                        double error, Found *found)
{
    const whole n = s->degree;
    Part parts[DEEPEST + 2];
    whole number = 1;
    parts[0].low = 0;
    parts[0].width = 1;
    parts[0].error = error;
    for (whole i = 0; i <= n; i++) parts[0].form[i] = form[i];
    while (number) {
        Part part = parts[--number];
        const int state = look(n, part.form, part.error);
        if (state == 0) continue;
        if (state == 3 || number > DEEPEST || part.width < 0x1p-39) return 1;
        if (state == 1) {
            const int rising = part.form[n] > part.form[0];
            const double share = root_of(s, part.form);
            note(found, polished(s, span, o, d, part.low, part.width, share, rising), rising ? 1 : -1);
            continue;
        }
        Part *right = parts + number, *left = right + 1; /* the left one is looked at first */
        left->error = right->error = part.error + (n + 2) * UNIT * largest_of(n, part.form);
        for (whole k = 0; k <= n; k++) {
            left->form[k] = part.form[0];
            right->form[n - k] = part.form[n - k];
            for (whole i = 0; i < n - k; i++) part.form[i] = (part.form[i] + part.form[i + 1]) / 2;
        }
        left->width = right->width = part.width / 2;
        left->low = part.low;
        right->low = part.low + part.width / 2;
        number += 2;
    }
    return 0;
}

/* What is on a stretch: 0 no root, 1 none near its ends, where the ray may be outside the cell, 2 it cannot be decided. */
static int ends_of(whole n, const Span *span, const double *form, double error)
{
    double low = form[0], high = form[0], slope = 0;
    for (whole i = 1; i <= n; i++) {
        const double step = fabs(form[i] - form[i - 1]);
        low = form[i] < low ? form[i] : low;
        high = form[i] > high ? form[i] : high;
        slope = step > slope ? step : slope;
    }
    if (low > error || high < -error) return 0;
    if (!(span->first < span->last)) return 2;
    const double begin = 2 * (span->first - span->enter) / span->length;
    const double end = isinf(span->leave) ? 0 : 2 * (span->leave - span->last) / span->length;
    slope = n * (slope + 2 * error); /* at most, in shares */
    return fabs(form[0]) > error + slope * (begin < 1 ? begin : 1) && fabs(form[n]) > error + slope * (end < 1 ? end : 1)
               ? 1
               : 2;
}

/* One ray in some stretches: 1 where it cannot be decided. */
static int shoot(const Scene *s, whole count, const double *o, const double *d, int close, Found *found)
{
    for (whole i = 0; i < count; i++) {
        const Span *span = s->spans + i;
        double form[MOST];
        const double error = error_on(s, span, o, d, close);
        form_on(s, span, o, d, form);
        const int state = ends_of(s->degree, span, form, error);
        const int result = state == 1 ? on_stretch(s, span, o, d, form, error, found) : state / 2;
        if (result) return result;
    }
    return 0;
}

/* `numbers` holds how many cells (none for a polynomial in all of space) and the degree; `bounds` the growth of errors,
   the reach, and how large coordinates are for which polynomials have their `largest` sizes.  The crossings found are
   counted in `number`; there is `room` for so many. */
int pas_rays(const whole *numbers, const double *bounds, const double *maps, const double *widths, const double *clear,
             const whole *piece_of, const double *tables, const double *sizes, const double *jets, const double *nodes,
             const double *to_bernstein, const double *largest, whole count, const double *origins,
             const double *directions, whole room, whole *rays, double *parameters, whole *sides, whole *exact,
             whole *number)
{
    const whole cells = numbers[0], n = numbers[1];
    Scene s = {.cells = cells, .degree = n, .maps = maps, .widths = widths, .clear = clear, .piece_of = piece_of,
               .tables = tables, .sizes = sizes, .jets = jets, .largest = largest, .growth = bounds[0],
               .reach = bounds[1], .farthest = bounds[2],
               .bounds = malloc((4 * cells + 1) * sizeof(double)), .spans = malloc((cells + 1) * sizeof(Span))};
    for (whole k = 0; k < MOST; k++) {
        s.nodes[k / WIDE][k % WIDE] = nodes[k <= n ? k : n];
        s.binomials[k][0] = 1;
        for (whole i = 1; i <= k; i++) s.binomials[k][i] = s.binomials[k][i - 1] * (k - i + 1) / i;
        for (whole i = 0; k <= n && i <= n; i++) s.to_bernstein[k][i / WIDE][i % WIDE] = to_bernstein[i * (n + 1) + k];
    }
    Found found = {room, 0, 0, rays, sides, parameters};
    const int state = s.bounds && s.spans ? 0 : -1;
    for (whole r = 0; state == 0 && r < count; r++) {
        const whole begun = found.number;
        const double *o = origins + 3 * r, *d = directions + 3 * r;
        const whole spans = stretches(&s, o, d);
        int result = 1;
        found.ray = r;
        for (int close = 0; close < 2 && result == 1; close++) {
            found.number = begun;
            result = shoot(&s, spans, o, d, close, &found);
        }
        exact[r] = result == 1;
        if (result == 1) found.number = begun;
    }
    *number = found.number;
    free(s.bounds);
    free(s.spans);
    return state;
}
