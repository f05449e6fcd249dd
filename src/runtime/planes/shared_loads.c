/*
 * The forces are f + N y for any y, where the columns of N are forces that balance each other. Newton's method finds the centre
 * of all whose shares are below a level, where the sum of -log(level^2 - share^2) is least, and the level falls to what is just
 * above these shares, until it is 1 or no lower one can be: a weighted mean of the shares at a centre is a bound for the largest
 * of any forces (Huard's method of centres).
 */
#include "planes/shared_loads.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "arithmetic.h"
#include "planes/pivoting.h"

enum { CENTRE_STEPS = 1000 };

/* Levers that differ by less of themselves are the same, as the constraints' are in saddle.h. */
static const double least_lever_share = 1e-6;

/* Less to spare is rounding; so much may rounding take. */
static const double least_spare = 2e-12, rounded_spare = 1e-9;

/* Steps as short as this, in units of the centre's width, have come near it, and to it. */
static const double near_centre = 0.1, at_centre = 1e-3;

/* Of what is between the level and the largest share, the next level leaves so much. */
static const double part_of_level = 0.25;

struct Centre {
  struct SharedLoad *load;
  size_t n, free_count;     /* forces, and columns of N */
  double *balance;          /* N, by rows */
  double *slope, *curve;    /* the derivatives of the sum of logarithms by y, and the second ones */
  double *step, *order;     /* order: of the forces, in the elimination */
  double level, largest;    /* share */
  double weights, weighted; /* of the shares: the sum, and that of the shares by their weights */
  double bound, distance;   /* of the largest share that any forces have; to the centre, in units of its width */
};

static size_t load_work_count(size_t n) {
  return 2 * n * n + 3 * n;
}

size_t shared_load_bytes(size_t rows, size_t count) {
  return (rows * 2 * count + 2 * count + load_work_count(2 * count)) * sizeof(double);
}

struct SharedLoad shared_load_in(void *block, size_t rows, size_t count) {
  struct SharedLoad load = {.rows = rows, .count = count, .lever = block};
  load.share = load.lever + rows * 2 * count;
  load.work = load.share + 2 * count;
  return load;
}

double shared_load_size(const struct SharedLoad *load, size_t plane) {
  return hypot(load->share[2 * plane], load->share[2 * plane + 1]);
}

/* Gauss and Jordan's elimination of the levers, with full pivoting. Returns how many are independent. */
static size_t eliminate_levers(const struct Centre *centre) {
  size_t n = centre->n, rows = centre->load->rows, rank = 0;
  double largest = 0.0, *a = centre->load->lever;
  const struct Pivoting pivoting = {.rows = rows, .columns = n, .matrix = a, .order = centre->order};
  pivoting_begin(&pivoting);
  for (; rank < rows && rank < n; rank++) {
    size_t taken;
    double pivot = pivoting_take(&pivoting, rank, &taken);
    largest = fmax(largest, pivot);
    if (!(pivot > least_lever_share * largest)) break;
    for (size_t j = n; j-- > rank;) a[rank * n + j] /= a[rank * n + rank];
    for (size_t i = 0; i < rows; i++) {
      double share = a[i * n + rank];
      for (size_t j = rank; j < n && i != rank && share != 0.0; j++) a[i * n + j] -= share * a[rank * n + j];
    }
  }
  return rank;
}

static void fill_balance(struct Centre *centre) {
  size_t n = centre->n, rank = eliminate_levers(centre), count = n - rank;
  centre->free_count = count;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < count; j++) {
      double *element = &centre->balance[(size_t)centre->order[i] * count + j];
      if (i < rank) *element = -centre->load->lever[i * n + rank + j];
      else *element = i - rank == j ? 1.0 : 0.0;
    }
}

static double largest_share(const struct SharedLoad *load) {
  double largest = 0.0;
  for (size_t i = 0; i < load->count; i++) largest = fmax(largest, shared_load_size(load, i));
  return largest;
}

/* What one plane adds to the derivatives, at the room level^2 - share^2; along: half the derivatives of this square by y. */
static void add_plane(struct Centre *centre, size_t plane, double room, double *along) {
  size_t count = centre->free_count;
  const double *share = centre->load->share + 2 * plane, *row = centre->balance + 2 * plane * count;
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

/* By Cholesky's factors. */
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

/* A step of Newton's method, as long as the shares surely stay below the level. */
static void come_nearer(struct Centre *centre) {
  size_t count = centre->free_count;
  fill_derivatives(centre);
  step_to_centre(centre);
  double part = centre->distance < 0.25 ? 1.0 : 1.0 / (1.0 + centre->distance);
  for (size_t i = 0; i < centre->n; i++)
    for (size_t j = 0; j < count; j++)
      centre->load->share[i] += part * centre->balance[i * count + j] * centre->step[j];
  centre->largest = largest_share(centre->load);
  /* Beside the centre the mean errs by less than this distance times how wide it is where forces may be, in the same units. */
  double pieces = 2.0 * (double)centre->load->count;
  centre->bound = (centre->weighted - centre->distance * (pieces + 2.0 * sqrt(pieces))) / centre->weights;
}

/* Whether the search has ended; else the level falls where the centre is near. */
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
  struct Centre centre = {.load = load, .n = n, .balance = load->work};
  centre.curve = centre.balance + n * n;
  centre.slope = centre.curve + n * n;
  centre.step = centre.slope + n;
  centre.order = centre.step + n;
  fill_balance(&centre);
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
