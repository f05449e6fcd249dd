#include "contacts/pushes.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/planes.h"
#include "evaluation/evaluate.h"
#include "evaluation/services.h"

/* Flights shorter than this many units in the last place of the time count as rest: their ends cannot be separated. */
static const double shortest_flight = 1000.0;
/* In units of the method's error: bounces lower than this are lost in it, and some methods would sustain them. */
static const double lost_share = 0.02;

bool is_touching(const struct Settlement *settlement, size_t contact) {
  size_t gap = contact_place(settlement->switches, contact, CONTACT_GAP);
  double noise = settlement_noise(settlement, gap, gap + CONTACT_RATE);
  return settlement->value[gap] <= noise || is_hit(settlement, contact_indicator(settlement->switches, contact));
}

bool contact_is_at_rest(const struct Settlement *settlement, size_t contact) {
  size_t rate = contact_place(settlement->switches, contact, CONTACT_RATE);
  if (contact_is_closed(settlement, contact)) return true;
  return is_touching(settlement, contact) && settlement->value[rate] <= settlement->noise[rate];
}

/* Returns the height of bounces that the method's error hides; 0 if rounding is the only error. */
static double lost_height(const struct Settlement *settlement) {
  return settlement->occasion == IN_EXCHANGE ? 0.0 : lost_share * solver_error(settlement->instance);
}

bool bounce_is_lost(const struct Settlement *settlement, size_t contact, double rate) {
  size_t gap = contact_place(settlement->switches, contact, CONTACT_GAP);
  double fall = -settlement->value[gap + CONTACT_ACCELERATION];
  double start = settlement->instance->situation->start_time;
  double resolution = DBL_EPSILON * fmax(fabs(settlement->time), fabs(settlement->time - start));
  if (rate <= settlement->noise[gap + CONTACT_RATE] || 2.0 * rate <= shortest_flight * resolution * fall) return true;
  /* Rounding, and even more an importer, leaves the gap slightly negative: a flight that ends there has no zero. */
  double depth = settlement->occasion == IN_EXCHANGE ? 10.0 : 1.0;
  double lost = fmax(4.0 * settlement_noise(settlement, gap, gap + CONTACT_RATE), -depth * settlement->value[gap]);
  return rate * rate <= 2.0 * fall * fmax(lost, lost_height(settlement));
}

void set_friction(struct Settlement *settlement, size_t friction, double mode) {
  const struct SwitchTable *switches = settlement->switches;
  size_t plane = plane_of(switches, friction);
  if (plane < switches->plane_count) switches->friction_laws->set_plane(settlement, plane, mode != 0.0);
  else settlement_set_mode(settlement, switches->frictions[friction].mode, mode);
}

double sliding_share(const struct Settlement *settlement, size_t friction) {
  const struct SwitchTable *switches = settlement->switches;
  size_t plane = plane_of(switches, friction);
  double mode = mode_of(settlement, switches->frictions[friction].mode);
  if (plane == switches->plane_count) return mode;
  const struct PlaneFacts *facts = &switches->planes[plane];
  double speed = speed_in_plane(settlement, facts->along);
  bool has_heading = mode < 0.0 && (speed == 0.0 || mode_of(settlement, facts->upper) > 0.0);
  if (has_heading) return mode_of(settlement, facts->heading[friction - facts->along]);
  return settlement->value[friction_place(switches, friction, FRICTION_VELOCITY)] / speed;
}

bool rests_on(const struct SwitchTable *switches, size_t friction, size_t contact) {
  return switches->rests_on != NULL && switches->rests_on[friction * switches->contact_count + contact];
}

static bool contact_takes_part(const struct Settlement *settlement, size_t contact) {
  return settlement->takes_part[contact] != 0.0;
}

static bool friction_takes_part(const struct Settlement *settlement, size_t friction) {
  const struct SwitchTable *switches = settlement->switches;
  bool rests = false;
  for (size_t i = 0; i < switches->contact_count; i++)
    rests |= contact_takes_part(settlement, i) && rests_on(switches, friction, i);
  return rests && !switches->frictions[friction].is_given &&
         settlement->takes_part[switches->contact_count + friction] != 0.0;
}

static size_t constraint_of(const struct Pushes *pushes, const struct SwitchTable *switches, size_t row) {
  size_t member = pushes->member[row];
  return row < pushes->contact_count ? switches->contacts[member].constraint : switches->frictions[member].constraint;
}

/*
 * Computes the effect of each unit impulse: in lever (count rows) the generalized impulses, rows of J, and in
 * pushes->velocities M^-1 J^T; then their products W. False if M is singular.
 */
static bool respond_to_pushes(struct Settlement *settlement, struct Pushes *pushes, double *lever, double *impulse,
                              double *response) {
  struct Instance *instance = settlement->instance;
  size_t n = lagrangian.coordinate_count;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  struct Point point = solver_point(instance, settlement->time, settlement->state);
  for (size_t row = 0; row < pushes->count; row++) {
    size_t place = n + constraint_of(pushes, settlement->switches, row);
    impulse[place] = 1.0;
    instance->singular = lagrangian.constraints.respond(&point, impulse, response);
    impulse[place] = 0.0;
    if (instance->singular != 0 || !are_finite(response, 2 * n)) return false;
    memcpy(pushes->velocities + row * n, response, n * sizeof *response);
    memcpy(lever + row * n, response + n, n * sizeof *response);
  }
  for (size_t i = 0; i < pushes->count; i++)
    for (size_t j = 0; j < pushes->count; j++) {
      double *mobility = &pushes->mobility[i * pushes->count + j];
      *mobility = 0.0;
      for (size_t k = 0; k < n; k++) *mobility += lever[i * n + k] * pushes->velocities[j * n + k];
    }
  return true;
}

/* Computes the friction limits by unit contact forces: differences to the limits without force, as these are linear. */
static void find_coefficients(struct Settlement *settlement, struct Pushes *pushes, double *force, double *value) {
  struct Point point = solver_point(settlement->instance, settlement->time, settlement->state);
  size_t contacts = pushes->contact_count, n = lagrangian.coordinate_count;
  for (size_t i = 0; i <= contacts && pushes->friction_count > 0; i++) {
    if (i < contacts) force[n + constraint_of(pushes, settlement->switches, i)] = 1.0;
    settlement->switches->switching_values(&point, force, value);
    if (i < contacts) force[n + constraint_of(pushes, settlement->switches, i)] = 0.0;
    for (size_t f = 0; f < pushes->friction_count; f++) {
      double sliding = value[friction_place(settlement->switches, pushes->member[contacts + f], FRICTION_FORCE)];
      if (i < contacts) pushes->coefficient[f * contacts + i] = sliding;
      else /* without any contact force */
        for (size_t k = 0; k < contacts; k++)
          pushes->coefficient[f * contacts + k] = fmax(pushes->coefficient[f * contacts + k] - sliding, 0.0);
    }
  }
}

static void find_rates(const struct Settlement *settlement, struct Pushes *pushes) {
  for (size_t row = 0; row < pushes->count; row++) {
    size_t member = pushes->member[row];
    size_t place = row < pushes->contact_count ? contact_place(settlement->switches, member, CONTACT_RATE)
                                               : friction_place(settlement->switches, member, FRICTION_VELOCITY);
    pushes->rate[row] = settlement->value[place];
    pushes->rounding = fmax(pushes->rounding, settlement->noise[place]);
  }
}

bool pushes_create(struct Settlement *settlement, struct Pushes *pushes) {
  const struct SwitchTable *switches = settlement->switches;
  size_t n = lagrangian.coordinate_count, rows = n + lagrangian.constraints.count;
  size_t values = settlement_value_count(switches), contacts = 0, frictions = 0;
  for (size_t i = 0; i < switches->contact_count; i++) contacts += contact_takes_part(settlement, i) ? 1 : 0;
  for (size_t i = 0; i < switches->friction_count; i++) frictions += friction_takes_part(settlement, i) ? 1 : 0;
  *pushes = (struct Pushes){.contact_count = contacts, .friction_count = frictions, .count = contacts + frictions};
  size_t count = pushes->count, numbers = 2 * count * n + count * count + count + frictions * contacts;
  size_t scratch = rows + 2 * n + values;
  pushes->block =
      scratch_take(settlement->instance, SCRATCH_PUSHES, (numbers + scratch) * sizeof(double) + count * sizeof(size_t));
  if (pushes->block == NULL) {
    solver_lacks_memory(settlement->instance);
    return false;
  }
  pushes->velocities = pushes->block;
  double *lever = pushes->velocities + count * n;
  pushes->mobility = lever + count * n;
  pushes->rate = pushes->mobility + count * count;
  pushes->coefficient = pushes->rate + count;
  double *force = pushes->coefficient + frictions * contacts, *response = force + rows, *value = response + 2 * n;
  pushes->member = (size_t *)(value + values);
  size_t next = 0;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (contact_takes_part(settlement, i)) pushes->member[next++] = i;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (friction_takes_part(settlement, i)) pushes->member[next++] = i;
  if (respond_to_pushes(settlement, pushes, lever, force, response)) {
    find_coefficients(settlement, pushes, force, value);
    find_rates(settlement, pushes);
    return true;
  }
  pushes_free(settlement, pushes);
  return false;
}

void pushes_free(const struct Settlement *settlement, struct Pushes *pushes) {
  scratch_return(settlement->instance, SCRATCH_PUSHES);
  pushes->block = NULL;
}
