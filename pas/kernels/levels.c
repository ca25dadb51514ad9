/* Where polynomials pass levels along rays. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define BLOCK 64
#define WORD 8
#define LEVELS 3
#define MOST 65

/* Values (samples, BLOCK) at shares of rays by their profiles, which are `stride` apart, and how many of the levels
   -band, 0 and band each reaches. */
FAST
static void sampled(whole n, whole stride, const double *profiles, whole samples, const double *shares, double band,
                    double *values, signed char *rungs)
{
    for (whole s = 0; s < samples; s++) {
        const double share = shares[s];
        double v[BLOCK];
        for (int r = 0; r < BLOCK; r++) v[r] = profiles[n * stride + r];
        for (whole k = n - 1; k >= 0; k--) {
            const double *row = profiles + k * stride;
            for (int r = 0; r < BLOCK; r++) v[r] = v[r] * share + row[r];
        }
        for (int r = 0; r < BLOCK; r++) values[s * BLOCK + r] = v[r];
        for (int r = 0; r < BLOCK; r++)
            rungs[s * BLOCK + r] = (signed char)((v[r] >= -band) + (v[r] >= 0) + (v[r] >= band));
    }
}

/* Crossings by rising rays, shares and levels: ray numbers, shares, and slopes of the profiles (n + 1, rays) there.
   There must be room for one of each level in each step of each ray.  Returns -1 where there are more than `MOST`
   samples, or no memory. */
int pas_levels(whole n, whole rays, const double *profiles, whole samples, const double *shares, double band,
               whole *ray_of, double *share_of, double *slope_of, whole *number)
{
    const double levels[LEVELS] = {-band, 0, band};
    double *values = malloc(samples * BLOCK * sizeof(double)), *last = calloc((n + 1) * BLOCK, sizeof(double));
    signed char *rungs = malloc(samples * BLOCK);
    const int good = values && last && rungs && samples <= MOST;
    whole found = 0;
    for (whole start = 0; good && start < rays; start += BLOCK) {
        const whole size = rays - start < BLOCK ? rays - start : BLOCK;
        if (size == BLOCK) sampled(n, rays, profiles + start, samples, shares, band, values, rungs);
        else {
            for (whole k = 0; k <= n; k++)
                for (whole r = 0; r < size; r++) last[k * BLOCK + r] = profiles[k * rays + start + r];
            sampled(n, BLOCK, last, samples, shares, band, values, rungs);
        }
        for (whole first = 0; first < size; first += WORD) {
            uint64_t steps[WORD] = {0};  /* after which a ray is on another rung, a bit each */
            for (whole s = 0; s + 1 < samples; s++) {
                const signed char *low = rungs + s * BLOCK + first, *high = low + BLOCK;
                if (memcmp(low, high, WORD))
                    for (int i = 0; i < WORD; i++) steps[i] |= (uint64_t)(low[i] != high[i]) << s;
            }
            for (whole r = first; r < first + WORD && r < size; r++)
                for (uint64_t left = steps[r - first]; left; left &= left - 1) {
                    const whole s = __builtin_ctzll(left), at = s * BLOCK + r;
                    const int low = rungs[at], high = rungs[at + BLOCK], up = low < high;
                    for (int i = up ? low : high; i < (up ? high : low); i++) {
                        const double a = values[at] - levels[i], b = values[at + BLOCK] - levels[i];
                        const double share = shares[s] + a / (a - b) * shares[1];
                        double slope = 0;
                        for (whole k = n; k > 0; k--) slope = slope * share + k * profiles[k * rays + start + r];
                        ray_of[found] = start + r;
                        share_of[found] = share;
                        slope_of[found++] = slope;
                    }
                }
        }
    }
    *number = found;
    free(values);
    free(last);
    free(rungs);
    return good ? 0 : -1;
}
