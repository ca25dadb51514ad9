/* The signatures of all functions of the library: included by every source, so that the compiler checks them, and read
   by library.py, which declares them to ctypes.  They return 0, or else there was no memory; those with other results
   are called from C alone.

   Arrays of numbers are `double` or `whole`, of truth values `char`; what is `const` is only read. */

#ifndef PAS_H
#define PAS_H

#include <stddef.h>

typedef ptrdiff_t whole;

/* collapses.c */
int pas_collapsed(whole count, const whole *triangles, whole size, const double *points, const double *normals,
                  const double *sizes, whole number, whole inner, const whole *edges, const whole *rim,
                  const char *fixed, double at_most, double longer, double turned, whole most, whole *target);

/* contour.c */
int pas_crossings(whole count, const whole *tetrahedra, whole size, const char *negative, whole *keys, whole *number);
int pas_oriented(whole count, whole *triangles, const double *points, const whole *edges, const double *nodes,
                 const char *negative);

/* drawn.c */
int pas_pieces_of(const whole *sizes, const double *maps, const whole *piece_of, whole count, const double *points,
                  whole *pieces);
int pas_bent(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees, const whole *starts,
             const double *tables, whole count, const double *points, double *values, double *gradients, double *bends);
int pas_drawn(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees, const whole *starts,
              const double *tables, const whole *all_degrees, const whole *all_starts, const double *all_tables,
              whole count, const double *points, const char *still, double left, double close, double *moved,
              double *gradients, double *bends, char *lost);
int pas_distances(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees,
                  const whole *starts, const double *tables, whole count, const double *points, double *distances);
int pas_closed(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees, const whole *starts,
               const double *tables, whole count, whole steps, double close, double *points, double *gradients);
int pas_on_rings(whole rings, const whole *degrees, const whole *starts, const double *tables, const double *middles,
                 const double *normals, whole count, const double *points, const whole *numbers, whole steps,
                 double settled, double *result);
int pas_slid(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees, const whole *starts,
             const double *tables, whole walls, const double *planes, const double *across, const double *back,
             const whole *numbers, whole steps, double settled, double farthest, whole count, double *points);

/* fans.c */
int pas_fans(whole count, const whole *triangles, whole size, const char *among, whole some, char *kinds);
int pas_is_manifold(whole count, const whole *triangles, whole size, whole *manifold);
int pas_pieces(whole count, const whole *triangles, whole size, whole *parent, whole *number);

/* finer.c */
int pas_finer(whole count, const whole *triangles, whole size, const double *points, const double *normals, whole edges,
              const whole *ends, const whole *edge_of, whole m, const double *shares, whole inner,
              const double *weights, const whole *corners, const whole *sides, const whole *within, whole parts,
              const whole *cut, whole *grid, double *fresh, whole *result);

/* forms.c */
int pas_ranges(whole n, whole m, const double *lattice, const double *inverse, whole higher, const double *raising,
               const double *coefficients, whole count, const double *corners, double *low, double *high);
int pas_slopes(whole n, whole m, const double *lattice, const double *inverse, const double *coefficients, whole count,
               const double *corners, const double *normals, double *least, double *sizes);
int pas_leaving(whole faces, const double *weights, whole count, const double *points, double *multiples, whole *face);
void pas_deepest(whole cells, const double *maps, whole count, const double *points, whole *cell);
int pas_located(const whole *sizes, const double *maps, const whole *piece_of, const double *normals, const whole *table,
                const whole *starts, const double *walls, whole count, const double *points, double tolerance,
                whole *pieces);

/* horner.c */
int pas_horner(whole n, whole points, const double *coefficients, const double *x, const double *y, const double *z,
               double *values);
int pas_mixed(whole pieces, whole count, const whole *degrees, const whole *starts, const double *tables, whole points,
              const double *places, whole stride, whole step, const whole *piece_of, double *values);

/* keys.c */
int pas_numbered(whole count, const whole *keys, whole wanted, whole *distinct, whole *inverse, whole *number);

/* labelled.c */
int pas_labelled_edges(whole count, const whole *triangles, const whole *labels, whole size, whole *room, whole *edges,
                       whole *both);
int pas_labelled_pairs(whole count, const whole *triangles, const whole *labels, whole size, whole span, whole *room,
                       whole *keys, whole *rows, whole *number);
int pas_cosines(whole number, const whole *chosen, const whole *triangles, const whole *corners, const double *points,
                const double *normals, double *cosines);
int pas_sizes(whole number, const whole *edges, const double *lengths, const char *seams, whole size, whole *room,
              double *total, double *sizes);
int pas_flipped_faces(whole count, whole *triangles, whole *corners, const whole *labels, whole size, whole *room,
                      const double *points, const double *normals, double *facing, const char *lines, whole lined,
                      double limit, char *near, whole bounded, whole passes, whole *flipped);

/* lattice.c */
int pas_eighths(whole count, whole m, whole means, const whole *halves, const whole *taken, const whole *corners,
                double rounding, const whole *keys, const double *points, const double *forms, whole *new_keys,
                double *new_points, double *new_forms, whole *number);
int pas_risings(whole count, whole m, whole lower, const whole *up, const double *forms, const double *points,
                double *means, double *least, double *sizes);

/* levels.c */
int pas_levels(whole n, whole rays, const double *profiles, whole samples, const double *shares, double band,
               whole *ray_of, double *share_of, double *slope_of, whole *number);

/* merges.c */
int pas_merged_faces(whole count, const whole *triangles, const whole *corners, const whole *labels, whole size,
                     const double *points, const double *normals, whole number, const whole *edges,
                     const whole *label_count, whole some, const whole *removed, const whole *kept, const double *most,
                     whole straight, const double *slenderest, whole span, double upright, double held, double turned,
                     whole most_rounds, char *chosen);

/* moves.c */
int pas_wanted_sizes(whole edges, const whole *every, whole inner, whole size, const double *points,
                     const double *bends, const char *fixed, double eight, double least_bend, double bent,
                     double least_bent, double grade, double *sizes);
int pas_moved(whole count, const whole *triangles, whole edges, const whole *every, whole inner, whole size,
              const double *points, const double *normals, const double *bends, const char *fixed, double eight,
              double least_bend, double bent, double least_bent, double grade, double *moved);
int pas_middles(whole count, const whole *chosen, const whole *triangles, whole edges, const whole *marked,
                const whole *ends, const double *points, double *middles);
int pas_slender(whole count, const whole *triangles, const double *points, whole *number);

/* octree.c */
int pas_tetrahedra(whole levels, const whole *halved, const whole *halved_ends, const whole *missed,
                   const whole *missed_ends, const whole *counts, whole *found);
int pas_tetrahedra_taken(whole count, whole place, whole *corners);

/* places.c */
int pas_better_places(whole count, const whole *vertices, const whole *starts, const whole *first, const whole *second,
                      const double *points, const double *normals, const double *before, const double *weights,
                      const double *floors, const double *limits, whole steps, const double *shares, whole turns,
                      const double *turned, double *places, double *was, double *left);
int pas_sines(whole count, const whole *triangles, const double *points, double *found);

/* radial.c */
int pas_met(const whole *sizes, const double *maps, const whole *piece_of, whole parts, const whole *degrees,
            const whole *starts, const double *tables, whole count, const double *points, whole steps, double settled,
            double *result);
int pas_around(const whole *sizes, const double *maps, const whole *piece_of, const whole *degrees, const whole *starts,
               const double *tables, whole rings, const double *middles, const double *squares, whole count,
               const double *points, whole steps, double settled, double most, double away, double *result);
int pas_near(const whole *sizes, const double *maps, const whole *piece_of, whole parts, const whole *degrees,
             const whole *starts, const double *tables, const whole *all_degrees, const whole *all_starts,
             const double *all_tables, whole count, const double *points, whole steps, double settled, double steep,
             double off, double *result, char *grazed);
int pas_once(whole parts, whole count, const double *profiles, const double *leave, whole samples, const double *shares,
             whole *once);

/* rays.c */
int pas_rays(const whole *numbers, const double *bounds, const double *maps, const double *widths, const double *clear,
             const whole *piece_of, const double *tables, const double *sizes, const double *jets, const double *nodes,
             const double *to_bernstein, const double *largest, whole count, const double *origins,
             const double *directions, whole room, whole *rays, double *parameters, whole *sides, whole *exact,
             whole *number);

/* simplices.c */
int pas_judged(whole count, whole m, whole d, whole lower, const whole *up, const double *forms, const double *corners,
               double bound, double roundings, whole *states);
int pas_halved(whole count, whole m, whole d, whole edges, const whole *pairs, whole means, const whole *halves,
               const whole *taken, const double *forms, const double *corners, double *new_forms, double *new_corners);

/* splits.c */
int pas_longest(whole count, const whole *triangles, whole size, whole edges, const whole *ends, const double *ratio,
                double limit, char *marks);
int pas_marked(whole count, const whole *triangles, whole size, const char *ends, whole edges, const whole *keys,
               whole *marks, whole *numbers);
int pas_split(whole count, const whole *triangles, whole size, const whole *marks, const whole *numbers, whole *parts,
              whole *parents);

/* triangles.c */
double pas_upright(const whole *triangle, const double *points, const double *normals);
int pas_uprights(whole count, const whole *triangles, const double *points, const double *normals, double *cosines);
int pas_edges(whole count, const whole *triangles, whole size, whole *room, whole sorted, whole *sizes);
int pas_listed(whole count, const whole *triangles, whole size, whole *room, whole inner, whole *every, whole *owners);
int pas_flipped(whole count, whole *triangles, whole size, whole *room, const double *points, const double *normals,
                whole passes, double gain, double turned, whole *sorted);
int pas_grown(whole count, const whole *edges, whole size, const double *points, double grade, double *lengths);
int pas_centred(whole count, const whole *triangles, whole size, const double *points, const double *sizes,
                double *moves);
int pas_settled(whole count, const whole *triangles, whole size, const double *before, double *after,
                const double *normals, double turned);

/* windings.c */
int pas_crossed(whole count, const whole *triangles, const double *points, const double *origin, whole ends,
                const double *ways, const double *towards, double grazing, double sure, whole *times, char *known);

#endif
