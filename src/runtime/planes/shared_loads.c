/*
 * Finds f with G f = load and all |f_i| < 1, in units of the limits, with a margin; else with the least largest |f_i|.
 * These forces are f + N y for any y, with the null space of G in the columns of N. For a level above the largest |f_i|
 * Newton's method minimizes the barrier - sum log(level^2 - |f_i|^2) over y; its minimum is the analytic centre. Far
 * from the centre steps are damped by 1 / (1 + decrement), so that |f_i| stays below the level (Nesterov and
 * Nemirovskii, Interior-Point Polynomial Algorithms in Convex Programming, 1994). Near the centre the level falls
 * towards the largest |f_i|, down to 1 (Huard's method of centres).
 *
 * At a centre a weighted mean of the |f_i| is a lower bound of the largest one of any distribution. The search ends at
 * the centre of level 1, if this bound exceeds 1, if the level meets the bound, or after CENTRE_STEPS steps. A step
 * costs O(m^3) for m columns of N, and O(m^2) for each plane.
 */
#include "planes/shared_loads.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "arithmetic.h"
#include "planes/pivoting.h"

/* Newton steps at most. */
enum { CENTRE_STEPS = 1000 };

/* Pivots below this share of the largest one count as 0, as sines below 1e-6 do in saddle.h. */
static const double least_jacobian_row_share = 1e-6;

/*
 * Margins below the first are rounding errors, and forces exceed limits by up to the second, both in units of the
 * limits.
 */
static const double least_spare = 2e-12, rounded_spare = 1e-9;

/* Newton decrements at which the level falls, and at which the centre of level 1 is reached. */
static const double near_centre = 0.1, at_centre = 1e-3;

/* The next level keeps this fraction of the distance from the largest force to the level. */
static const double part_of_level = 0.25;

/* The iteration towards the analytic centre. All |f_i| are below level. */
struct Centre {
  struct SharedLoad *load;
  size_t n, free_count;     /* number of forces, and of columns of N */
  double *response;         /* N, by rows */
  double *slope, *curve;    /* gradient and Hessian of the barrier by y */
  double *step, *order;     /* order: of the forces, after column exchanges */
  double level, largest;    /* level of the barrier, and the largest |f_i| */
  double weights, weighted; /* weights of the |f_i| in the bound: their sum, and the weighted sum of the |f_i| */
  double bound, distance;   /* lower bound of the largest |f_i| of any distribution; Newton decrement */
};

static size_t load_work_count(size_t n) {
  return 2 * n * n + 3 * n;
}

size_t shared_load_bytes(size_t rows, size_t count) {
  return (rows * 2 * count + 2 * count + load_work_count(2 * count)) * sizeof(double);
}

struct SharedLoad shared_load_in(void *block, size_t rows, size_t count) {
  struct SharedLoad load = {.rows = rows, .count = count, .jacobian_row = block};
  load.share = load.jacobian_row + rows * 2 * count;
  load.work = load.share + 2 * count;
  return load;
}

double shared_load_size(const struct SharedLoad *load, size_t plane) {
  return hypot(load->share[2 * plane], load->share[2 * plane + 1]);
}

/* Reduces G by Gauss-Jordan elimination with complete pivoting. Returns its rank. */
static size_t eliminate_jacobian_rows(const struct Centre *centre) {
  size_t n = centre->n, rows = centre->load->rows, rank = 0;
  double largest = 0.0, *a = centre->load->jacobian_row;
  const struct Pivoting pivoting = {.rows = rows, .columns = n, .matrix = a, .order = centre->order};
  pivoting_begin(&pivoting);
  for (; rank < rows && rank < n; rank++) {
    size_t taken;
    double pivot = pivoting_take(&pivoting, rank, &taken);
    largest = fmax(largest, pivot);
    if (!(pivot > least_jacobian_row_share * largest)) break;
    for (size_t j = n; j-- > rank;) a[rank * n + j] /= a[rank * n + rank];
    for (size_t i = 0; i < rows; i++) {
      double share = a[i * n + rank];
      for (size_t j = rank; j < n && i != rank && share != 0.0; j++) a[i * n + j] -= share * a[rank * n + j];
    }
  }
  return rank;
}

static void fill_null_vector(struct Centre *centre) {
  size_t n = centre->n, rank = eliminate_jacobian_rows(centre), count = n - rank;
  centre->free_count = count;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < count; j++) {
      double *element = &centre->response[(size_t)centre->order[i] * count + j];
      if (i < rank) *element = -centre->load->jacobian_row[i * n + rank + j];
      else *element = i - rank == j ? 1.0 : 0.0;
    }
}

static double largest_share(const struct SharedLoad *load) {
  double largest = 0.0;
  for (size_t i = 0; i < load->count; i++) largest = fmax(largest, shared_load_size(load, i));
  return largest;
}

/* Adds a plane's terms to gradient and Hessian. room: level^2 - |f_i|^2; along: half the gradient of |f_i|^2 by y. */
static void add_plane(struct Centre *centre, size_t plane, double room, double *along) {
  size_t count = centre->free_count;
  const double *share = centre->load->share + 2 * plane, *row = centre->response + 2 * plane * count;
  for (size_t j = 0; j < count; j++) {
    along[j] = share[0] * row[j] + share[1] * row[count + j];
    centre->slope[j] += 2.0 * along[j] / room;
  }
  for (size_t j = 0; j < count; j++)
    for (size_t k = 0; k <= j; k++) {
      double product = row[j] * row[k] + row[count + j] * row[count + k];
      centre->curve[j * count + k] += 2.0 * product / room + 4.0 * along[j] / room * (along[k] / room);
    }
}

static void fill_derivatives(struct Centre *centre) {
  centre->weights = centre->weighted = 0.0;
  memset(centre->slope, 0, centre->free_count * sizeof(double));
  memset(centre->curve, 0, centre->free_count * centre->free_count * sizeof(double));
  for (size_t i = 0; i < centre->load->count; i++) {
    double share = shared_load_size(centre->load, i), room = (centre->level - share) * (centre->level + share);
    add_plane(centre, i, room, centre->step);
    centre->weights += 2.0 * share / room;
    centre->weighted += 2.0 * share * share / room;
  }
}

/* Finds the Newton step by Cholesky's factorization, and the Newton decrement. */
static void step_to_centre(struct Centre *centre) {
  size_t n = centre->free_count;
  double *l = centre->curve, *step = centre->step, square = 0.0;
  for (size_t i = 0; i < n; i++) {
    step[i] = -centre->slope[i];
    for (size_t j = 0; j <= i; j++) {
      for (size_t k = 0; k < j; k++) l[i * n + j] -= l[i * n + k] * l[j * n + k];
      l[i * n + j] = i == j ? sqrt(l[i * n + i]) : l[i * n + j] / l[j * n + j];
      if (j < i) step[i] -= l[i * n + j] * step[j];
    }
    step[i] /= l[i * n + i];
    square += step[i] * step[i];
  }
  centre->distance = sqrt(square);
  for (size_t i = n; i-- > 0;) {
    for (size_t j = i + 1; j < n; j++) step[i] -= l[j * n + i] * step[j];
    step[i] /= l[i * n + i];
  }
}

/* Makes a damped Newton step, which keeps all |f_i| below the level; then updates largest and bound. */
static void come_nearer(struct Centre *centre) {
  size_t count = centre->free_count;
  fill_derivatives(centre);
  step_to_centre(centre);
  double part = centre->distance < 0.25 ? 1.0 : 1.0 / (1.0 + centre->distance);
  for (size_t i = 0; i < centre->n; i++)
    for (size_t j = 0; j < count; j++)
      centre->load->share[i] += part * centre->response[i * count + j] * centre->step[j];
  centre->largest = largest_share(centre->load);
  /* Off the centre the mean errs by at most the decrement times the width of the feasible set, in the local norm. */
  double pieces = 2.0 * (double)centre->load->count;
  centre->bound = (centre->weighted - centre->distance * (pieces + 2.0 * sqrt(pieces))) / centre->weights;
}

/* True if the search has ended; else lowers the level if the centre is near. */
static bool has_ended(struct Centre *centre) {
  if (!isfinite(centre->distance) || !(centre->largest < centre->level)) return true;
  if (!(centre->level > 1.0)) return !(centre->distance > at_centre);
  if (centre->distance > near_centre) return false;
  double next = centre->largest + part_of_level * (centre->level - centre->largest);
  if (centre->largest < 1.0) next = fmax(next, 1.0);
  centre->level = next;
  return centre->bound > 1.0 + rounded_spare || next - centre->bound < least_spare;
}

enum LoadSharing shared_load_carry(struct SharedLoad *load) {
  size_t n = 2 * load->count;
  struct Centre centre = {.load = load, .n = n, .response = load->work};
  centre.curve = centre.response + n * n;
  centre.slope = centre.curve + n * n;
  centre.step = centre.slope + n;
  centre.order = centre.step + n;
  fill_null_vector(&centre);
  centre.largest = largest_share(load);
  if (centre.free_count == 0) return LOAD_OVERCOMES;
  centre.level = fmax(2.0 * centre.largest, 1.0);
  for (int step = 0; step < CENTRE_STEPS; step++) {
    come_nearer(&centre);
    if (has_ended(&centre)) break;
  }
  if (!isfinite(centre.distance)) return LOAD_OVERCOMES;
  if (centre.largest < 1.0 - least_spare) return LOAD_IS_SHARED;
  return centre.largest < 1.0 + rounded_spare ? LOAD_IS_AT_LIMIT : LOAD_OVERCOMES;
}
