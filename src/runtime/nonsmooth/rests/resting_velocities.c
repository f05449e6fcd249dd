/*
 * Finds the velocities at rest. Let J have the rows of all active constraints J v = b. A velocity v_i rests if e_i
 * is in the row space of J and the right sides give it the value 0. The projection of velocities onto the
 * constraints, v - M^-1 J^T (J M^-1 J^T)^+ (J v - b), decides that without further algebra: it takes v_i from any v
 * to 0. So random velocities are projected, once at the present point and once at a point nearby, which the motion
 * may reach without an event. It has coordinates moved along the projected velocities, another time, other states,
 * and other values of inputs that may vary. Velocities that the coordinates, time or inputs make 0 only for an
 * instant are not at rest. A decision costs two projections. It is correct with probability 1, up to rounding
 * errors.
 *
 * The indicator of a branch that is linear in several velocities, sum_i a_i v_i + r, has the value r if the sum rests.
 * The same projections decide that: they take a sum at rest to 0.
 *
 * A prescribed velocity rests if it is 0, and its acceleration is 0 here and nearby. Where a prescribed
 * motion stops, the error of integration may leave a small velocity. So a velocity also counts as at rest if it is small
 * and was accelerated until the event.
 */
#include "nonsmooth/rests/resting_velocities.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/prescribed_inputs.h"
#include "evaluation/services.h"
#include "support/next_random.h"

/* Largest velocity at rest after a projection, by rounding, in units of the scales of velocities. */
static const double projected_rest = 1e-10;

/*
 * In tolerances times the scale: the velocity that integration may leave where a prescribed motion stops. Importers
 * control their error less strictly.
 */
static const double integrated_rest = 10.0, integrated_rest_in_exchange = 1000.0;

/* Largest distance of the point nearby: relative, of coordinates, inputs and states; and in s, of time. */
static const double nearby = 0.01, later = 0.3;

/* A point at which velocities are tried. Its state is in workspace of the resolution. */
struct Probe {
  struct Resolution *resolution;
  struct Point point;
  double *state;
  uint32_t seed;
};

static bool has_kind(const struct SwitchTable *switches, enum RestingKind kind) {
  bool has = false;
  for (size_t i = 0; i < switches->resting_count; i++) has |= switches->resting[i].kind == kind;
  return has;
}

/* Returns a random number of magnitude 0.5 to 1, of either sign. */
static double random_number(struct Probe *probe) {
  double number = (double)next_random(&probe->seed) / (double)(1u << 24);
  return number < 0.5 ? number - 1.0 : number;
}

static struct Probe probe_here(struct Resolution *resolution) {
  struct Probe probe = {.resolution = resolution, .state = resolution->rounded, .seed = 1};
  memcpy(probe.state, resolution->state, lagrangian.state_count * sizeof *probe.state);
  probe.point = solver_point(resolution->instance, resolution->time, probe.state);
  return probe;
}

/*
 * True if the input may change without an event. Importers of model exchange may set it at any time, and inputs in
 * constraints become polynomials at the start of a communication step. Others change by events.
 */
static bool may_vary(const struct Instance *instance, size_t input) {
  return instance->kind == KIND_MODEL_EXCHANGE || is_prescribed_input(input);
}

/* Sets the probe's inputs to those of a later time, and moves the ones that may vary. */
static void move_inputs(struct Probe *probe) {
  struct Instance *instance = probe->resolution->instance;
  double *input = probe->resolution->probe_input;
  solver_move_point(instance, &probe->point, probe->point.time + later, probe->state);
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    double value = probe->point.input[i], distance = nearby * fmax(1.0, fabs(value)) * random_number(probe);
    input[i] = may_vary(instance, i) ? value + distance : value;
  }
  probe->point.input = input;
}

/* Moves the probe to the point nearby, with coordinates along its velocities. */
static void move_nearby(struct Probe *probe) {
  size_t n = lagrangian.coordinate_count;
  double largest = 0.0;
  for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(probe->state[n + i]) / scale_of(probe->state, i));
  for (size_t i = 0; i < n && largest > 0.0; i++) probe->state[i] += nearby / largest * probe->state[n + i];
  for (size_t i = 2 * n; i < lagrangian.state_count; i++)
    probe->state[i] += nearby * scale_of(probe->state, i) * random_number(probe);
  move_inputs(probe);
}

/* True if the prescribed velocity may be at rest: it is 0, or as small as the error of an integration. */
static bool is_small(const struct Resolution *resolution, size_t number) {
  const struct RestingMetadata *resting = &resolution->switches->resting[number];
  size_t velocity = lagrangian.coordinate_count + resting->index;
  double size = fabs(resolution->state[velocity]);
  bool has_stopped = mode_of(resolution, resting->mode) != VELOCITY_MOVES;
  double share = resolution->occasion == IN_EXCHANGE ? integrated_rest_in_exchange : integrated_rest;
  double error = share * resolution->instance->fmu_state->tolerance * scale_of(resolution->state, velocity);
  return size == 0.0 || (resolution->occasion != AT_START && has_stopped && size <= error);
}

/* Marks prescribed velocities that accelerate; NULL for accelerations that do not exist. */
static void mark_accelerating(struct Resolution *resolution, const double *acceleration) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].kind == RESTING_PRESCRIBED &&
        (acceleration == NULL || acceleration[switches->resting[i].index] != 0.0))
      resolution->moves[i] = VELOCITY_ACCELERATES;
}

/* Finds the prescribed velocities that accelerate at the present point or nearby. */
static void find_accelerating(struct Resolution *resolution) {
  double *acceleration = resolution->probe_acceleration;
  struct Probe probe = probe_here(resolution);
  mark_accelerating(resolution, resolution_accelerations(resolution));
  move_nearby(&probe);
  bool exist = lagrangian.constraints.accelerations(&probe.point, acceleration) == 0;
  mark_accelerating(resolution, exist ? acceleration : NULL);
}

/* Gives the probe random velocities, but 0 to prescribed ones at rest. */
static void scatter_velocities(struct Probe *probe) {
  const struct SwitchTable *switches = probe->resolution->switches;
  size_t n = lagrangian.coordinate_count;
  for (size_t i = 0; i < n; i++) probe->state[n + i] = lagrangian.steps.nominal[n + i] * random_number(probe);
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].kind == RESTING_PRESCRIBED && probe->resolution->moves[i] == VELOCITY_RESTS)
      probe->state[n + switches->resting[i].index] = 0.0;
}

/* Writes the sums of velocities at the probe. */
static void find_sums(const struct Probe *probe, double *sums) {
  const struct Resolution *resolution = probe->resolution;
  if (resolution->switches->resting_sums != NULL)
    resolution->switches->resting_sums(&probe->point, resolution->acceleration, sums);
}

/* Projects random velocities at the probe, and marks those that do not become 0 as moving. */
static void find_moving(struct Probe *probe) {
  struct Resolution *resolution = probe->resolution;
  const struct SwitchTable *switches = resolution->switches;
  size_t n = lagrangian.coordinate_count;
  double *random = resolution->probe_sums, *projected = random + switches->resting_count;
  scatter_velocities(probe);
  find_sums(probe, random);
  bool exist = lagrangian.constraints.correct_velocities(&probe->point, resolution->correction) == 0;
  for (size_t i = 0; i < n && exist; i++) probe->state[n + i] += resolution->correction[i];
  find_sums(probe, projected);
  for (size_t i = 0; i < switches->resting_count; i++) {
    size_t index = switches->resting[i].index;
    bool is_sum = switches->resting[i].kind == RESTING_SUM;
    double left = is_sum ? projected[index] : probe->state[n + index];
    double scale = is_sum ? fabs(random[index]) : lagrangian.steps.nominal[n + index];
    bool rests = exist && fabs(left) <= projected_rest * scale;
    if (!rests) resolution->moves[i] = fmax(resolution->moves[i], VELOCITY_MOVES);
  }
}

void resting_find(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool may_rest = solver_has_constraints(resolution->instance), has_prescribed = has_kind(switches, RESTING_PRESCRIBED);
  for (size_t i = 0; i < switches->resting_count; i++) {
    bool is_prescribed = switches->resting[i].kind == RESTING_PRESCRIBED;
    bool moves = is_prescribed ? !is_small(resolution, i) : !may_rest;
    resolution->moves[i] = moves ? VELOCITY_MOVES : VELOCITY_RESTS;
    may_rest |= is_prescribed && !moves;
  }
  if (!(may_rest || has_prescribed) || evaluate_prepare(resolution->instance) != STATUS_DONE) return;
  if (has_prescribed) find_accelerating(resolution);
  if (!may_rest) return;
  struct Probe probe = probe_here(resolution);
  find_moving(&probe);
  move_nearby(&probe);
  find_moving(&probe);
}
