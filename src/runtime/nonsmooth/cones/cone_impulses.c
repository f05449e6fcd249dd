/* Solves the problem of cone_search.c in an event resolution. */
#include "nonsmooth/cones/cone_impulses.h"

#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "nonsmooth/cones/cone_newton.h"
#include "nonsmooth/cones/cone_search.h"
#include "support/next_random.h"

/* Other impulses of up to this number of rows are searched, from this number of random starts. */
enum { OTHER_ROWS = 12, RANDOM_STARTS = 64 };

/* Trials from each start in the search for other impulses, and their largest relative residual. */
enum { OTHER_LAW_TRIALS = 2 };
static const double law_nearly_holds = 1e-9;

/* Directions of the friction impulses at which the search for other impulses starts. Along a line the last two are 0. */
static const double start_directions[][2] = {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}};
enum { DIRECTIONS = sizeof start_directions / sizeof *start_directions };

/* Takes workspace for the cones; also for the impulses if impulse is NULL. False without memory. */
static bool create_cones(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                         const double *rate, double *impulse, struct Cones *cones) {
  size_t n = impulses->count;
  *cones = (struct Cones){
      .resolution = resolution, .path = resolution->switches->cone_path, .impulses = impulses, .rate = rate};
  size_t count = n + cones_lay_out(cones, n, NULL);
  double *block = scratch_take(resolution->instance, SCRATCH_CONES, count * sizeof *block);
  if (block == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  cones_lay_out(cones, n, block + n);
  cones->impulse = impulse != NULL ? impulse : block;
  return true;
}

bool cone_impulses_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                        double *impulse) {
  struct Cones cones;
  if (!create_cones(resolution, impulses, rate, impulse, &cones)) return false;
  bool is_done = cones_find_impulses(&cones);
  scratch_return(resolution->instance, SCRATCH_CONES);
  return is_done;
}

/* Continues from impulses of other rates by Newton's method. Returns the relative residual; size: the largest impulse. */
static double continue_by_newton(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                 const double *rate, double *impulse, double *size) {
  struct Cones cones;
  *size = 0.0;
  if (!create_cones(resolution, impulses, rate, impulse, &cones)) return INFINITY;
  bool moves = cones_fill_scales(&cones);
  double miss = moves ? cones_relative_miss(&cones, cone_newton(&cones, whole_step, cones.work)) : INFINITY;
  *size = cones_largest(&cones);
  scratch_return(resolution->instance, SCRATCH_CONES);
  return miss;
}

bool cone_impulses_continue(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                            const double *rate, double *impulse) {
  double size;
  return continue_by_newton(resolution, impulses, rate, impulse, &size) <= law_nearly_holds;
}

bool cone_forces_continue(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                          const double *rate, double *force, double *error) {
  double size, miss = continue_by_newton(resolution, impulses, rate, force, &size);
  *error = 2.0 * miss * size;
  return miss <= law_roughly_holds;
}

bool cone_forces_find(const struct Resolution *resolution, const struct ContactImpulses *impulses, const double *rate,
                      double *force, double *error) {
  struct Cones cones;
  if (!create_cones(resolution, impulses, rate, force, &cones)) return false;
  double miss = cones_find_forces(&cones);
  bool is_done = miss <= law_roughly_holds;
  *error = is_done ? 2.0 * miss * cones_largest(&cones) : INFINITY;
  scratch_return(resolution->instance, SCRATCH_CONES);
  return is_done;
}

/* Returns a random number from 0 to count - 1. */
static size_t random_below(uint32_t *seed, size_t count) {
  return next_random(seed) % count;
}

/* Lets the frictions push to their limits: in one of the directions, or in random ones for DIRECTIONS. */
static void fill_frictions(struct Cones *cones, size_t direction, uint32_t *seed) {
  for (size_t row = cones->impulses->contact_count; row < cones->impulses->count;) {
    const double *way = start_directions[direction < DIRECTIONS ? direction : random_below(seed, DIRECTIONS)];
    size_t rows = cones_row_count(cones, row);
    cones->impulse[row] = way[0] * cones_limit(cones, row);
    if (rows == 2) cones->impulse[row + 1] = way[1] * cones_limit(cones, row + 1);
    row += rows;
  }
}

/* Fills a start where one contact has the largest impulse, the others none, and its frictions push in one direction. */
static void fill_single_start(struct Cones *cones, double largest, size_t number) {
  memset(cones->impulse, 0, cones->impulses->count * sizeof *cones->impulse);
  cones->impulse[number / DIRECTIONS] = largest;
  fill_frictions(cones, number % DIRECTIONS, NULL);
}

/* Fills a random start: a third of the contacts has no impulse, others 1/20 to 20 times the largest one. */
static void fill_random_start(struct Cones *cones, double largest, uint32_t *seed) {
  for (size_t i = 0; i < cones->impulses->contact_count; i++) {
    bool presses = random_below(seed, 3) != 0;
    cones->impulse[i] = presses ? largest * exp((double)random_below(seed, 7) - 3.0) : 0.0;
  }
  fill_frictions(cones, DIRECTIONS, seed);
}

bool cone_impulses_have_others(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                               const double *rate, const double *impulse) {
  struct Cones cones;
  uint32_t seed = 1;
  size_t n = impulses->count, single = impulses->contact_count * DIRECTIONS;
  if (n > OTHER_ROWS || !create_cones(resolution, impulses, rate, NULL, &cones)) return false;
  double largest = 0.0;
  bool is_other = false, moves = cones_fill_scales(&cones);
  for (size_t i = 0; i < impulses->contact_count; i++) largest = fmax(largest, impulse[i]);
  for (size_t i = 0; i < single + RANDOM_STARTS && moves && !is_other; i++) {
    if (i < single) fill_single_start(&cones, largest, i);
    else fill_random_start(&cones, largest, &seed);
    memcpy(cones.swept, cones.impulse, n * sizeof *cones.impulse);
    double miss = cones_search_from(&cones, AT_ONCE, OTHER_LAW_TRIALS);
    is_other = miss <= law_nearly_holds && is_other_outcome(impulses, cones.impulse, impulse);
  }
  scratch_return(resolution->instance, SCRATCH_CONES);
  return is_other;
}
