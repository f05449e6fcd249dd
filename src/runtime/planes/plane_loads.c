/*
 * Distributes the load of sticking frictions in planes. A body that stands on more points than it needs sticks if
 * any forces f with G f = load, |f_i| <= stiction_i, exist. Those of least norm, which the equations of motion
 * yield, may violate the limits. G has the generalized forces of unit forces, columns of J^T. Forces in its null
 * space balance each other along all coordinates, so that the contact forces stay the same. The frictions that G
 * couples with the one that exceeds its limit take part. shared_loads.c finds the forces.
 */
#include "planes/plane_loads.h"

#include <math.h>
#include <string.h>

#include "contacts/frictions.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "planes/shared_loads.h"

/* Switches of a friction in an event up to which it may share: its limit may change with the contact forces. */
enum { SHARE_LIMIT = 5 };

/* If some frictions must slide, those begin whose force is within this share of the limit. */
static const double share_at_limit = 1e-9;

/* Frictions are weak if their limit is below this share of the largest one. */
static const double weak_share = 0.01;

/* The distribution of one load among planes. */
struct PlaneLoads {
  struct Resolution *resolution;
  size_t n;             /* number of coordinates */
  size_t count;         /* number of planes that take part */
  double *jacobian_row; /* generalized forces of unit forces: 2 rows for each plane of the table */
  double *buffer;       /* for a response, and the impulse that causes it */
  double *member;       /* for each plane of the table: 1 if it takes part, else 0 */
};

static bool carries(const struct PlaneLoads *loads, size_t plane) {
  struct PlaneState state = plane_state(loads->resolution, plane);
  bool is_slow = state.mode == PLANE_SLIPS && !state.is_free && !plane_moves(&state);
  bool rests = state.mode == PLANE_STICKS || (is_slow && plane_has_part(loads->resolution, &state));
  return rests && !state.is_given && state.stiction > 0.0 && state.sliding > 0.0;
}

static size_t count_carrying(const struct PlaneLoads *loads) {
  size_t count = 0;
  for (size_t i = 0; i < loads->resolution->switches->plane_count; i++) count += carries(loads, i) ? 1 : 0;
  return count;
}

/* Fills the generalized forces. False if M is singular. */
static bool fill_jacobian_rows(const struct PlaneLoads *loads) {
  struct Instance *instance = loads->resolution->instance;
  const struct SwitchTable *switches = loads->resolution->switches;
  size_t n = loads->n;
  double *response = loads->buffer, *impulse = response + 2 * n;
  struct Point point = solver_point(instance, loads->resolution->time, loads->resolution->state);
  for (size_t row = 0; row < 2 * switches->plane_count; row++) {
    if (!carries(loads, row / 2)) continue;
    size_t slot = n + switches->frictions[switches->planes[row / 2].along + row % 2].constraint;
    impulse[slot] = 1.0;
    instance->singular = lagrangian.constraints.respond(&point, impulse, response);
    impulse[slot] = 0.0;
    if (instance->singular != 0 || !are_finite(response, 2 * n)) return false;
    memcpy(loads->jacobian_row + row * n, response + n, n * sizeof *response);
  }
  return true;
}

static bool act_on_the_same(const struct PlaneLoads *loads, size_t i, size_t j) {
  const double *one = loads->jacobian_row + 2 * i * loads->n, *other = loads->jacobian_row + 2 * j * loads->n;
  bool same = false;
  for (size_t k = 0; k < loads->n; k++)
    same |= (one[k] != 0.0 || one[loads->n + k] != 0.0) && (other[k] != 0.0 || other[loads->n + k] != 0.0);
  return same;
}

/* Collects the planes that act on the same coordinates as the first one, directly or through others. */
static void collect_members(struct PlaneLoads *loads, size_t first) {
  size_t count = loads->resolution->switches->plane_count;
  loads->member[first] = 1.0;
  loads->count = 1;
  for (bool grows = true; grows;) {
    grows = false;
    for (size_t i = 0; i < count; i++)
      for (size_t j = 0; j < count; j++) {
        if (loads->member[i] == 0.0 || loads->member[j] != 0.0 || !act_on_the_same(loads, i, j)) continue;
        loads->member[j] = 1.0;
        loads->count++;
        grows = true;
      }
  }
}

static void fill_load(const struct PlaneLoads *loads, struct SharedLoad *load) {
  size_t next = 0;
  for (size_t i = 0; i < loads->resolution->switches->plane_count; i++) {
    if (loads->member[i] == 0.0) continue;
    struct PlaneState state = plane_state(loads->resolution, i);
    for (size_t side = 0; side < 2; side++) {
      load->share[2 * next + side] = state.force[side] / state.stiction;
      for (size_t k = 0; k < loads->n; k++)
        load->jacobian_row[k * 2 * load->count + 2 * next + side] =
            state.stiction * loads->jacobian_row[(2 * i + side) * loads->n + k];
    }
    next++;
  }
}

/* Applies the forces that were found. slides: frictions at their limits begin to slide against their forces. */
static void take_forces(const struct PlaneLoads *loads, const struct SharedLoad *load, bool slides) {
  size_t next = 0;
  for (size_t i = 0; i < loads->resolution->switches->plane_count; i++) {
    if (loads->member[i] == 0.0) continue;
    struct PlaneState state = plane_state(loads->resolution, i);
    const double *share = load->share + 2 * next, force[] = {share[0] * state.stiction, share[1] * state.stiction};
    if (slides && shared_load_size(load, next) > 1.0 - share_at_limit) plane_slip(loads->resolution, &state, force);
    else plane_carry(loads->resolution, &state, force);
    next++;
  }
}

/*
 * Weak frictions are those whose contacts are about to open. They get friction forces without constraints if others
 * constrain their velocities, since constraints would take too much of a changing load again and again. False if
 * that cannot be determined.
 */
static bool release_weak(const struct PlaneLoads *loads) {
  struct Resolution *resolution = loads->resolution;
  double most = 0.0;
  for (size_t i = 0; i < resolution->switches->plane_count; i++)
    if (loads->member[i] != 0.0) most = fmax(most, plane_state(resolution, i).stiction);
  bool is_determined = true;
  for (size_t i = 0; i < resolution->switches->plane_count && is_determined; i++) {
    struct PlaneState state = plane_state(resolution, i);
    bool is_constrained = false, is_weak = state.stiction < weak_share * most && plane_has_part(resolution, &state);
    if (loads->member[i] == 0.0 || !is_weak) continue;
    plane_release(resolution, &state);
    is_determined = frictions_find_constrained(resolution, state.metadata->along, &is_constrained);
    if (!is_constrained) plane_hold(resolution, &state);
  }
  return is_determined;
}

/* Distributes the load of the planes that take part. False if that is impossible. */
static bool share_load(const struct PlaneLoads *loads) {
  struct Instance *instance = loads->resolution->instance;
  void *block = scratch_take(instance, SCRATCH_SHARES, shared_load_bytes(loads->n, loads->count));
  if (block == NULL) {
    solver_is_out_of_memory(instance);
    return false;
  }
  struct SharedLoad load = shared_load_in(block, loads->n, loads->count);
  fill_load(loads, &load);
  enum LoadSharing sharing = shared_load_carry(&load);
  if (sharing != LOAD_OVERCOMES) take_forces(loads, &load, sharing == LOAD_IS_AT_LIMIT);
  scratch_return(instance, SCRATCH_SHARES);
  return sharing == LOAD_IS_AT_LIMIT || (sharing == LOAD_IS_SHARED && release_weak(loads));
}

bool plane_loads_share(struct Resolution *resolution, size_t plane) {
  const struct SwitchTable *switches = resolution->switches;
  struct PlaneLoads loads = {.resolution = resolution, .n = lagrangian.coordinate_count};
  struct PlaneState state = plane_state(resolution, plane);
  bool is_tired = resolution->flips[friction_indicator(switches, state.metadata->along)] >= SHARE_LIMIT;
  if (is_tired || !carries(&loads, plane) || count_carrying(&loads) < 2) return false;
  if (lagrangian.constraints.respond == NULL || evaluate_prepare(resolution->instance) != STATUS_DONE) return false;
  size_t jacobian_rows = 2 * switches->plane_count * loads.n, buffer = 3 * loads.n + lagrangian.constraints.count;
  loads.jacobian_row = scratch_take(resolution->instance, SCRATCH_JACOBIAN_ROWS,
                                    (jacobian_rows + buffer + switches->plane_count) * sizeof *loads.jacobian_row);
  if (loads.jacobian_row == NULL) {
    solver_is_out_of_memory(resolution->instance);
    return false;
  }
  loads.buffer = loads.jacobian_row + jacobian_rows;
  loads.member = loads.buffer + buffer;
  bool is_done = fill_jacobian_rows(&loads);
  if (is_done) collect_members(&loads, plane);
  is_done = is_done && loads.count > 1 && share_load(&loads);
  if (is_done) plane_count_switch(resolution, &state);
  scratch_return(resolution->instance, SCRATCH_JACOBIAN_ROWS);
  return is_done;
}
