/*
 * Finds the velocities at rest. With the rows J of all active constraints J v = b, a velocity v_i rests if e_i is in
 * the row space of J and the right sides give it the value 0. The projection of velocities onto the constraints, v -
 * M^-1 J^T (J M^-1 J^T)^+ (J v - b), decides that without further algebra: it takes v_i from any v to 0. So random
 * velocities are projected, once at the present point and once at a point nearby, which the motion may reach without an
 * event: coordinates moved along the projected velocities, another time, other inputs and states. Velocities that the
 * coordinates, time or inputs make 0 only for an instant are not at rest. A decision costs two projections, with
 * probability 1 it is right but for rounding errors.
 *
 * A prescribed velocity rests if it is 0, and its acceleration is 0 here and nearby. The error of the method may leave
 * it other than 0 where a drive stops.
 */
#include "rests/resting_velocities.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"

/* Largest velocity at rest after a projection, by rounding, in units of the scales of velocities. */
static const double projected_rest = 1e-10;

/*
 * In tolerances, relative to the scale: the velocity that an integration of a drive to rest may leave. Importers keep
 * the tolerance less strictly.
 */
static const double integrated_rest = 10.0, integrated_rest_in_exchange = 1000.0;

/* Largest relative distance of coordinates, inputs and states to the point nearby; and of time, in s. */
static const double nearby = 0.01, later = 0.3;

/* The point of a decision; the state is its own. */
struct Probe {
  struct Resolution *resolution;
  struct Point point;
  double *state;
  uint32_t seed;
};

/* Returns a random number of size 0.5 to 1. Constants by D. E. Knuth and H. W. Lewis. */
static double random_number(struct Probe *probe) {
  probe->seed = probe->seed * 1664525u + 1013904223u;
  double number = (double)(probe->seed >> 8) / (double)(1u << 24);
  return number < 0.5 ? number - 1.0 : number;
}

static struct Probe probe_here(struct Resolution *resolution) {
  struct Probe probe = {.resolution = resolution, .state = resolution->rounded, .seed = 1};
  memcpy(probe.state, resolution->state, lagrangian.state_count * sizeof *probe.state);
  probe.point = solver_point(resolution->instance, resolution->time, probe.state);
  return probe;
}

/* Moves the probe to the point nearby, with coordinates along its velocities. */
static void move_nearby(struct Probe *probe) {
  size_t n = lagrangian.coordinate_count;
  double *input = probe->resolution->probe_input, largest = 0.0;
  for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(probe->state[n + i]) / scale_of(probe->state, i));
  for (size_t i = 0; i < n && largest > 0.0; i++) probe->state[i] += nearby / largest * probe->state[n + i];
  for (size_t i = 2 * n; i < lagrangian.state_count; i++)
    probe->state[i] += nearby * scale_of(probe->state, i) * random_number(probe);
  for (size_t i = 0; i < lagrangian.input_count; i++)
    input[i] = probe->point.input[i] + nearby * fmax(1.0, fabs(probe->point.input[i])) * random_number(probe);
  probe->point.input = input;
  probe->point.time += later;
}

/* True if the prescribed velocity may be at rest: it is 0, or as small as the error of an integration. */
static bool is_small(const struct Resolution *resolution, size_t number) {
  const struct RestingMetadata *resting = &resolution->switches->resting[number];
  size_t velocity = lagrangian.coordinate_count + resting->coordinate;
  double size = fabs(resolution->state[velocity]);
  bool has_stopped = resolution->drove[number] != 0.0 || mode_of(resolution, resting->mode) == 0.0;
  double share = resolution->occasion == IN_EXCHANGE ? integrated_rest_in_exchange : integrated_rest;
  double error = share * resolution->instance->fmu_state->tolerance * scale_of(resolution->state, velocity);
  return size == 0.0 || (resolution->occasion != AT_START && has_stopped && size <= error);
}

/* Lets prescribed velocities move whose accelerations at the probe are not 0. */
static void find_driven(struct Probe *probe) {
  struct Resolution *resolution = probe->resolution;
  const struct SwitchTable *switches = resolution->switches;
  double *acceleration = resolution->probe_acceleration;
  bool exist = lagrangian.constraints.accelerations(&probe->point, acceleration) == 0;
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].is_prescribed && !(exist && acceleration[switches->resting[i].coordinate] == 0.0))
      resolution->moves[i] = 1.0;
}

/* Gives the probe random velocities, but 0 to prescribed ones at rest. */
static void scatter_velocities(struct Probe *probe) {
  const struct SwitchTable *switches = probe->resolution->switches;
  size_t n = lagrangian.coordinate_count;
  for (size_t i = 0; i < n; i++) probe->state[n + i] = lagrangian.steps.nominal[n + i] * random_number(probe);
  for (size_t i = 0; i < switches->resting_count; i++)
    if (switches->resting[i].is_prescribed && probe->resolution->moves[i] == 0.0)
      probe->state[n + switches->resting[i].coordinate] = 0.0;
}

/* Projects random velocities at the probe, and lets those move that do not become 0. */
static void find_moving(struct Probe *probe) {
  struct Resolution *resolution = probe->resolution;
  const struct SwitchTable *switches = resolution->switches;
  size_t n = lagrangian.coordinate_count;
  scatter_velocities(probe);
  bool exist = lagrangian.constraints.correct_velocities(&probe->point, resolution->correction) == 0;
  for (size_t i = 0; i < n && exist; i++) probe->state[n + i] += resolution->correction[i];
  for (size_t i = 0; i < switches->resting_count; i++) {
    size_t velocity = n + switches->resting[i].coordinate;
    bool rests = exist && fabs(probe->state[velocity]) <= projected_rest * lagrangian.steps.nominal[velocity];
    if (!rests) resolution->moves[i] = 1.0;
  }
}

void resting_find(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool may_rest = solver_has_constraints(resolution->instance);
  for (size_t i = 0; i < switches->resting_count; i++) {
    bool is_prescribed = switches->resting[i].is_prescribed;
    resolution->moves[i] = is_prescribed ? !is_small(resolution, i) : !may_rest;
    may_rest |= is_prescribed && resolution->moves[i] == 0.0;
  }
  if (!may_rest || evaluate_prepare(resolution->instance) != STATUS_DONE) return;
  struct Probe probe = probe_here(resolution);
  find_driven(&probe);
  move_nearby(&probe);
  find_driven(&probe);
  probe = probe_here(resolution);
  find_moving(&probe);
  move_nearby(&probe);
  find_moving(&probe);
}
