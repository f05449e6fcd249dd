/*
 * Taylor series of the motion (A. Jorba, M. Zou: A software package for the numerical integration of ODEs by means of
 * high-order Taylor methods, 2005). The order follows from the tolerance, the step from taylor_reach.c. A step reaches
 * past the communication point; the series is evaluated there, and goes on to serve the next communication step unless
 * inputs, parameters or the state were changed. The situation holds all that a step depends on.
 */
#include <math.h>

#include "evaluate.h"
#include "log.h"
#include "solver.h"
#include "taylor.h"

enum { STEP_LIMIT = 10000000 }; /* steps in one communication step */
enum { CRAWL_STEPS = 1000 };    /* so many steps of one kind move a system further than the tolerance */

static size_t saved_size(void) {
  return sizeof(struct Saved) + lagrangian.state_count * (sizeof(double) + sizeof(Series));
}

static bool create(struct Instance *instance) {
  size_t rows = lagrangian.input_count + lagrangian.series_rows;
  size_t terms = 2 * lagrangian.state_count * sizeof(double);
  struct Taylor *taylor = instance->allocate(1, sizeof *taylor + rows * sizeof(Series) + terms);
  if (taylor == NULL) {
    log_message(instance, fmi2Error, "allocateMemory returned no memory for the solver");
    return false;
  }
  taylor->saved = instance->saved;
  taylor->low = (double *)(taylor->saved + 1);
  taylor->x = (Series *)(taylor->low + lagrangian.state_count);
  taylor->input = (Series *)(taylor + 1);
  taylor->work = taylor->input + lagrangian.input_count;
  taylor->term = (double *)(taylor->work + lagrangian.series_rows);
  taylor->derivative = taylor->term + lagrangian.state_count;
  instance->solver_memory = taylor;
  return true;
}

static void destroy(struct Instance *instance) {
  instance->free(instance->solver_memory);
  instance->solver_memory = NULL;
}

/*
 * d state / dt at the origin, and the first coefficients of all series, which are there already where the defect was
 * measured. False where there are no accelerations.
 */
static bool start(struct Instance *instance, struct Taylor *taylor) {
  if (taylor->is_measured) return true;
  for (size_t i = 0; i < lagrangian.state_count; i++) instance->work[i] = taylor->x[i][0];
  instance->singular = taylor_start(instance, taylor, taylor->saved->origin, taylor->derivative);
  return instance->singular == 0;
}

/* The series about the origin, where x[i][0] is the state, and its reach. False where no step can be taken. */
static bool expand(struct Instance *instance, struct Taylor *taylor, double communication_step) {
  struct Saved *saved = taylor->saved;
  saved->reach = 0.0;
  if (!start(instance, taylor)) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++) taylor->x[i][1] = taylor->derivative[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) expand_input(instance, i, saved->origin, taylor->input[i]);
  struct Point point = evaluate_point(instance);
  point.time = saved->origin;
  lagrangian.series(&point, (int)saved->order, (const Series *)taylor->input, taylor->x, taylor->work);
  instance->situation->statistics[STATISTIC_DERIVATIVES]++;
  taylor_choose_reach(instance, taylor, communication_step);
  return saved->reach > 0.0;
}

/*
 * Moves the origin to the end of the series; what rounding takes from the state is carried along in low. Returns the
 * largest change in units of the variables' scales.
 */
static double advance(struct Instance *instance, struct Taylor *taylor) {
  struct Saved *saved = taylor->saved;
  double largest = 0.0;
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    double change = taylor->is_measured ? taylor->term[i] : taylor_change(taylor, i, saved->reach);
    double before = taylor->x[i][0], term = change + taylor->low[i];
    double sum = before + term, part = sum - before, moved = fabs(term) / taylor_scale(taylor, i);
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
  taylor->saved->origin = instance->situation->time;
  taylor->saved->reach = 0.0;
  taylor->is_measured = false;
  double order = ceil(1.0 - 0.5 * log(taylor_tolerance(instance)));
  taylor->saved->order = (int64_t)fmin(fmax(order, 4.0), SERIES_LENGTH - 2);
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    taylor->low[i] = 0.0;
    taylor->x[i][0] = instance->state[i];
  }
}

static void evaluate_state(struct Instance *instance, const struct Taylor *taylor, double time) {
  double s = time - taylor->saved->origin;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    instance->state[i] = taylor->x[i][0] + (taylor_change(taylor, i, s) + taylor->low[i]);
}

/* The state becomes that of the origin. */
static enum StepResult stop(struct Instance *instance, const struct Taylor *taylor, double end, const char *reason) {
  double origin = taylor->saved->origin;
  const char *function = taylor->function;
  if (instance->singular != 0) log_singularity(instance, fmi2Discard, origin);
  log_message(instance, fmi2Discard,
              "the Taylor series stopped at time %.15g before %.15g: %s%s%s; retrying will not help; go on from an "
              "earlier state with a larger tolerance, other parameters or other coordinates",
              origin, end, reason, function != NULL ? ", by " : "", function != NULL ? function : "");
  for (size_t i = 0; i < lagrangian.state_count; i++) {
    instance->state[i] = taylor->x[i][0];
    for (int k = 1; k < SERIES_LENGTH; k++) taylor->x[i][k] = 0.0;
  }
  instance->situation->changed = 1;
  return STEP_PARTIAL;
}

/* Steps of one kind that hardly move the system; the kind goes on where a thousand of them do not. */
struct Crawl {
  int steps;
  double path;
};

static bool crawls(struct Crawl *crawl, double moved, double tolerance) {
  crawl->path += moved;
  if (++crawl->steps < CRAWL_STEPS) return false;
  bool stays = crawl->path < CRAWL_STEPS * tolerance;
  *crawl = (struct Crawl){0};
  return stays;
}

/*
 * Expands and advances until the series reaches the end; NULL, or the reason why it never does. Where a system is
 * stiff, many steps hardly move it: none would need to be so short, but that its fast modes must not grow. Where dry
 * friction sticks, one jump comes after another.
 */
static const char *reach(struct Instance *instance, struct Taylor *taylor, double length, double end) {
  struct Saved *saved = taylor->saved;
  struct Crawl regular = {0}, crossing = {0};
  double tolerance = fmin(instance->situation->tolerance, 1e-6);
  for (long steps = 1; saved->reach == 0.0 || end > saved->origin + saved->reach; steps++) {
    double moved = saved->reach > 0.0 ? advance(instance, taylor) : 0.0;
    if (!taylor->crosses) crossing.path += moved;
    else if (crawls(&crossing, moved, 1e-9))
      return "a function jumps to and fro there, as dry friction that sticks; write it with tanh, or choose "
             "<solver method=\"erk\"/> in system.xml";
    if (!taylor->is_limited && crawls(&regular, moved, tolerance))
      return "the system is stiff there, which asks for <solver method=\"bdf\"/> in system.xml";
    if (!expand(instance, taylor, length)) return "the motion has a singularity there, or grows beyond all numbers";
    if (steps == STEP_LIMIT) return "too many steps";
  }
  return NULL;
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Taylor *taylor = instance->solver_memory;
  struct Saved *saved = taylor->saved;
  double time = instance->situation->time, end = time + length;
  if (instance->solver_is_stale) taylor->is_measured = instance->solver_is_stale = false;
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
