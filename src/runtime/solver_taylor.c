/*
 * Taylor series of the motion (A. Jorba, M. Zou: A software package for the numerical integration of ODEs by means of
 * high-order Taylor methods, 2005). The order follows from the tolerance, the step from the last two coefficients. A
 * step reaches past the communication point; the series is evaluated there, and goes on to serve the next communication
 * step unless inputs, parameters or the state were changed. The situation holds all that a step depends on.
 */
#include <math.h>

#include "evaluate.h"
#include "log.h"
#include "solver.h"

/* Local errors of the order of the tolerance add up to more than it; see tests/test_motion.py. */
static const double safety = 0.1;
enum { STEP_LIMIT = 10000000 }; /* steps in one communication step */
enum { STIFF_STEPS = 1000 };    /* in so many steps, a system that is not stiff moves */

/* What the situation holds for this solver. */
struct Saved {
  double origin; /* the time of the series */
  double reach;  /* how far from there it is right; 0 for no series yet */
  int64_t order;
  /* double low[state_count]: what rounding left of the state at origin; Series x[state_count] */
};

struct Taylor {
  struct Saved *saved;
  double *low;
  Series *x;            /* coefficients of the state; x[i][0] is the state at origin */
  Series *input, *work; /* coefficients of the inputs, workspace of lagrangian.series */
};

static size_t saved_size(void) {
  return sizeof(struct Saved) + lagrangian.state_count * (sizeof(double) + sizeof(Series));
}

static bool create(struct Instance *instance) {
  size_t rows = lagrangian.input_count + lagrangian.series_rows;
  struct Taylor *taylor = instance->allocate(1, sizeof *taylor + rows * sizeof(Series));
  if (taylor == NULL) {
    log_message(instance, fmi2Error, "allocateMemory returned no memory for the solver");
    return false;
  }
  taylor->saved = instance->saved;
  taylor->low = (double *)(taylor->saved + 1);
  taylor->x = (Series *)(taylor->low + lagrangian.state_count);
  taylor->input = (Series *)(taylor + 1);
  taylor->work = taylor->input + lagrangian.input_count;
  instance->solver_memory = taylor;
  return true;
}

static void destroy(struct Instance *instance) {
  instance->free(instance->solver_memory);
  instance->solver_memory = NULL;
}

static double scale(const struct Taylor *taylor, size_t i) {
  double size = fabs(taylor->x[i][0]);
  return size < lagrangian.nominal[i] ? lagrangian.nominal[i] : size;
}

/* The largest coefficient of this order, in units of the variables' scales. */
static double norm(const struct Taylor *taylor, int64_t order) {
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double size = fabs(taylor->x[i][order]) / scale(taylor, i);
    if (!(size <= largest)) largest = size;
  }
  return largest;
}

/* Jorba and Zou, section 3.2: where the last two terms are as small as the tolerance asks. */
static double radius(const struct Taylor *taylor) {
  double order = (double)taylor->saved->order;
  double last = norm(taylor, taylor->saved->order), before = norm(taylor, taylor->saved->order - 1);
  if (!isfinite(last + before)) return 0.0;
  return exp(-fmax(log(last) / order, log(before) / (order - 1.0)) - 2.0 - 0.7 / (order - 1.0));
}

/*
 * The series about the origin, where x[i][0] is the state. A step over a pulse in time would not see it, so that with
 * explicit time no series reaches further than the communication step. False where there are no accelerations.
 */
static bool expand(struct Instance *instance, struct Taylor *taylor, double communication_step) {
  struct Saved *saved = taylor->saved;
  double *state = instance->work;
  for (size_t i = 0; i < lagrangian.state_count; i++) state[i] = taylor->x[i][0];
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, saved->origin, taylor->input[i]);
  struct Point point = evaluate_point(instance);
  point.time = saved->origin;
  point.state = state;
  if (lagrangian.input_count > 0) {
    for (size_t i = 0; i < lagrangian.input_count; i++) state[lagrangian.state_count + i] = taylor->input[i][0];
    point.input = state + lagrangian.state_count;
  }
  instance->singular =
      lagrangian.series(&point, (int)saved->order, (const Series *)taylor->input, taylor->x, taylor->work);
  instance->situation->statistics[STATISTIC_DERIVATIVES]++;
  if (instance->singular != 0) return false;
  double reach = fmin(radius(taylor), 1e300);
  if (lagrangian.depends_on_time) reach = fmin(reach, communication_step);
  /* The next origin is a number, so that the time does not drift. */
  double next = saved->origin + reach;
  saved->reach = next - saved->origin;
  return saved->reach > 0.0;
}

/* The change of variable i over s: Horner's rule for even and odd powers apart, which do not wait for one another. */
static double change(const struct Taylor *taylor, size_t i, double s) {
  const double *x = taylor->x[i], square = s * s;
  int64_t j = taylor->saved->order;
  double first = x[j], second = x[j - 1];
  for (j -= 2; j > 1; j -= 2) {
    first = first * square + x[j];
    second = second * square + x[j - 1];
  }
  if (j == 1) return ((first * s + second) * s + x[1]) * s;
  return (first * s + second) * s;
}

/*
 * Moves the origin to the end of the series; what rounding takes from the state is carried along in low. Returns the
 * largest change in units of the variables' scales.
 */
static double advance(struct Instance *instance, struct Taylor *taylor) {
  struct Saved *saved = taylor->saved;
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double before = taylor->x[i][0], term = change(taylor, i, saved->reach) + taylor->low[i];
    double sum = before + term, part = sum - before, moved = fabs(term) / scale(taylor, i);
    if (moved > largest) largest = moved;
    taylor->low[i] = (before - (sum - part)) + (term - part);
    taylor->x[i][0] = sum;
  }
  saved->origin += saved->reach;
  saved->reach = 0.0;
  instance->situation->statistics[STATISTIC_STEPS]++;
  return largest;
}

static void begin(struct Instance *instance, struct Taylor *taylor) {
  double tolerance = fmax(safety * instance->situation->tolerance, 1e-17);
  taylor->saved->origin = instance->situation->time;
  taylor->saved->reach = 0.0;
  taylor->saved->order = (int64_t)fmin(fmax(ceil(1.0 - 0.5 * log(tolerance)), 4.0), SERIES_LENGTH - 2);
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    taylor->low[i] = 0.0;
    taylor->x[i][0] = instance->state[i];
  }
}

static void evaluate_state(struct Instance *instance, const struct Taylor *taylor, double time) {
  double s = time - taylor->saved->origin;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    instance->state[i] = taylor->x[i][0] + (change(taylor, i, s) + taylor->low[i]);
}

/* The state becomes that of the origin. */
static enum StepResult stop(struct Instance *instance, const struct Taylor *taylor, double end, const char *reason) {
  double origin = taylor->saved->origin;
  if (instance->singular != 0) log_singularity(instance, fmi2Discard, origin);
  log_message(instance, fmi2Discard,
              "the Taylor series stopped at time %.15g before %.15g: %s; retrying will not help; go on from an earlier "
              "state with a larger tolerance, other parameters or other coordinates",
              origin, end, reason);
  for (size_t i = 0; i < lagrangian.state_count; i++) instance->state[i] = taylor->x[i][0];
  instance->situation->changed = 1;
  return STEP_PARTIAL;
}

/*
 * Expands and advances until the series reaches the end; NULL, or the reason why it never does. Where a system is
 * stiff, many steps hardly move it: none would need to be so short, but that its fast modes must not grow.
 */
static const char *reach(struct Instance *instance, struct Taylor *taylor, double length, double end) {
  struct Saved *saved = taylor->saved;
  double path = 0.0;
  for (long steps = 1; saved->reach == 0.0 || end > saved->origin + saved->reach; steps++) {
    if (saved->reach > 0.0) path += advance(instance, taylor);
    if (!expand(instance, taylor, length)) return "the motion has a singularity there, or grows beyond all numbers";
    if (steps == STEP_LIMIT) return "too many steps";
    if (steps % STIFF_STEPS > 0) continue;
    if (path < STIFF_STEPS * instance->situation->tolerance)
      return "the system is stiff there, which asks for <solver method=\"bdf\"/> in system.xml";
    path = 0.0;
  }
  return NULL;
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Taylor *taylor = instance->solver_memory;
  struct Saved *saved = taylor->saved;
  double time = instance->situation->time, end = time + length;
  bool is_new = instance->situation->changed || !(time >= saved->origin && time <= saved->origin + saved->reach);
  if (is_new) begin(instance, taylor);
  instance->situation->changed = 0;
  const char *problem = reach(instance, taylor, length, end);
  if (problem == NULL) {
    evaluate_state(instance, taylor, end);
    for (size_t i = 0; i < lagrangian.state_count; i++)
      if (!isfinite(instance->state[i])) problem = "the motion grows beyond all numbers";
  }
  if (problem == NULL) return STEP_DONE;
  *reached = saved->origin;
  return stop(instance, taylor, end, problem);
}

const struct Solver solver_taylor = {.saved_size = saved_size, .create = create, .destroy = destroy, .step = step};
