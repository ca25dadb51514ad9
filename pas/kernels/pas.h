/* The signatures of all functions of the library: included by every source, so that the compiler checks them, and read
   by library.py, which declares them to ctypes.  They return 0, or else there was no memory.

   Arrays of numbers are `double` or `whole`, of truth values `char`; what is `const` is only read.  Other types are those
   of structures, of which addresses are given. */

#ifndef PAS_H
#define PAS_H

#include <stddef.h>

typedef ptrdiff_t whole;
typedef struct Mesh Mesh; /* see halfedge.h */

/* cut.c */
int pas_mesh_cut_counts(const Mesh *m, whole q, whole *base, whole *counts);
int pas_mesh_cut(const Mesh *m, whole q, const whole *base, double *points, whole *corners, whole *codes,
                 whole *labels);

/* edits.c */
int pas_mesh_split(Mesh *m, whole count, const whole *halves, const whole *ends);
int pas_mesh_flip(Mesh *m, double turned, double limit, whole only_fresh, whole passes);
int pas_mesh_collapse(Mesh *m, whole count, const whole *halves, const double *limits, whole *done);

/* forms.c */
int pas_ranges(whole n, whole m, const double *lattice, const double *inverse, whole higher, const double *raising,
               const double *coefficients, whole count, const double *corners, double *low, double *high);
int pas_slopes(whole n, whole m, const double *lattice, const double *inverse, const double *coefficients, whole count,
               const double *corners, const double *normals, double *least, double *sizes);
int pas_leaving(whole faces, const double *weights, const whole *piece_of, whole count, const double *points, whole stride,
                whole step, double *multiples, whole *pieces);
int pas_located(const whole *sizes, const double *maps, const whole *piece_of, const double *normals, const whole *table,
                const whole *starts, const double *walls, whole count, const double *points, double tolerance,
                whole *pieces);

/* halfedge.c */
int pas_twins(whole count, const whole *corners, whole size, whole *twins);
int pas_fans(whole count, const whole *corners, whole size, const whole *twins, whole *fans);
int pas_mesh_classify(Mesh *m);
int pas_mesh_pack(Mesh *m);
int pas_mesh_labels_about(const Mesh *m, whole count, const whole *chosen, whole width, whole *labels);
int pas_mesh_middles(const Mesh *m, whole count, const whole *rows, whole some, const whole *halves, double *middles);

/* horner.c */
int pas_horner(whole n, whole points, const double *coefficients, const double *x, const double *y, const double *z,
               double *values);
int pas_mixed(whole pieces, whole count, const whole *degrees, const whole *starts, const double *tables, whole points,
              whole first, whole last, const double *places, whole stride, whole step, const whole *piece_of,
              double *values);

/* keys.c */
int pas_numbered(whole count, const whole *keys, whole wanted, whole *distinct, whole *inverse, whole *number);

/* lengths.c */
int pas_mesh_bends(Mesh *m);
int pas_mesh_sizes(Mesh *m, double parts, double fine, double longest, double bent, double grade);
int pas_mesh_mean_sizes(Mesh *m);
int pas_mesh_ratios(const Mesh *m, double *ratios);

/* levels.c */
int pas_levels(whole n, whole rays, const double *profiles, whole samples, const double *shares, double band,
               whole *ray_of, double *share_of, double *slope_of, whole *number);

/* octree.c */
int pas_tetrahedra(whole levels, const whole *halved, const whole *halved_ends, const whole *missed,
                   const whole *missed_ends, const whole *counts, whole *found);
int pas_tetrahedra_taken(whole count, whole place, whole *corners);

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

/* smooth.c */
int pas_mesh_targets(const Mesh *m, double *to);
int pas_mesh_cosines(const Mesh *m, double *cosines);
int pas_mesh_settle(Mesh *m, const double *to, const double *normals, const double *bends, whole known, double turned);
int pas_mesh_sines(const Mesh *m, double *sines);
int pas_mesh_better(Mesh *m, double aim, whole count, const whole *vertices, whole *chosen, double *places,
                    whole *number);
int pas_mesh_stars(const Mesh *m, whole count, const whole *vertices, whole room, whole *rows, whole *owners,
                   whole *number);
int pas_mesh_move(Mesh *m, whole count, const whole *vertices, const double *places, const double *normals,
                  const char *good, double aim, double held, whole *moved);

/* windings.c */
int pas_crossed(whole count, const whole *triangles, const double *points, const double *origin, whole ends,
                const double *ways, const double *towards, double grazing, double sure, whole *times, char *known);

#endif
