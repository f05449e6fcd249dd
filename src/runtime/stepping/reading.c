#include "stepping/reading.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "stepping/start.h"

/* True if the reported values may differ from the stored state. */
static bool may_differ(const struct Instance *instance) {
  const struct FmuState *fmu_state = instance->fmu_state;
  if (instance->shown == NULL) return false; /* nothing moves the values that were set */
  if (fmu_state->phase == PHASE_INITIALIZATION) return true;
  return lagrangian.event_laws != NULL && fmu_state->phase == PHASE_STEP_COMPLETE &&
         fmu_state->changed == CHANGED_VALUES;
}

static void exchange_fmu_states(struct Instance *instance) {
  struct FmuState *other = instance->shown;
  instance->shown = instance->fmu_state;
  instance_use(instance, other);
  instance->parameter_constants_are_stale = true;
}

static void report_impossible_start(struct Instance *instance, const char *reason) {
  if (instance->reported_impossible_start) return;
  log_message(instance, STATUS_WARNING,
              "values in initialization mode are those that were set, since there is no consistent start: %s", reason);
  instance->reported_impossible_start = true;
}

/* Computes the reported values on the copy, without messages: the function that starts there will report failures. */
static void resolve_silently(struct Instance *instance) {
  char reason[MESSAGE_LENGTH] = "";
  struct Log log = instance->log;
  uint64_t reported_singularity = instance->reported_singularity;
  bool starts = instance->fmu_state->phase == PHASE_INITIALIZATION;
  instance->log = (struct Log){log_keep_first, reason, 1u << STATUS_DISCARD | 1u << STATUS_ERROR};
  if (starts) instance->shown_is_found = start_find(instance) == STATUS_DONE;
  else instance->shown_is_found = evaluate_prepare(instance) == STATUS_DONE && start_step(instance);
  instance->log = log;
  instance->reported_singularity = reported_singularity;
  if (instance->shown_is_found) return;
  memcpy(instance->fmu_state, instance->given, fmu_state_size());
  if (starts) report_impossible_start(instance, reason);
}

void reading_begin(struct Instance *instance) {
  if (!may_differ(instance)) return;
  bool is_new = memcmp(instance->given, instance->fmu_state, fmu_state_size()) != 0;
  if (is_new) memcpy(instance->given, instance->fmu_state, fmu_state_size());
  if (is_new || !instance->shown_is_found) memcpy(instance->shown, instance->fmu_state, fmu_state_size());
  exchange_fmu_states(instance);
  instance->is_reading = true;
  if (is_new) resolve_silently(instance);
  instance->modes_stay = instance->shown_is_found;
  instance->parameter_constants_are_stale = true;
}

void reading_end(struct Instance *instance) {
  if (!instance->is_reading) return;
  bool failed = instance->fmu_state->phase == PHASE_ERROR;
  exchange_fmu_states(instance);
  instance->is_reading = instance->modes_stay = false;
  if (!failed) return;
  instance->shown->phase = instance->fmu_state->phase;
  instance->fmu_state->phase = PHASE_ERROR;
}

/*
 * Displacements of the difference quotients, in units of the scales. The relative truncation error of the first is
 * about 1e-12. The others serve where the displaced starts are not smooth. Below 1e-6 a contact at rest would end the
 * bounces of displaced velocities, which hides the kink. The scales of inputs and parameters are at least 1; if no
 * start exists there, as beside an inertia of 1e-7 kg m2, they are the values themselves.
 */
static const double displacement[] = {1e-3, 1e-5, 1e-6};

/* Largest ratio of second difference and displacement that is not a kink, in units of the scales. */
static const double straight = 1e-2;

/* Returns the largest of count values, each divided by the scale of the variable that it changes. */
static double relative_size(const double *value, const double *of, size_t count, double least_scale) {
  double largest = 0.0;
  for (size_t i = 0; i < count; i++) {
    double scale = of[i] != 0.0 ? fmax(fabs(of[i]), least_scale) : 1.0;
    largest = fmax(largest, fabs(value[i]) / scale);
  }
  return largest;
}

/* least_scale: of inputs and parameters. */
static double size_of_seed(const struct Instance *instance, const struct Seed *seed, double least_scale) {
  double size = fabs(seed->time);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    size = fmax(size, fabs(seed->state[i]) / scale_of(instance->state, i));
  size = fmax(size, relative_size(seed->input, instance->input, lagrangian.input_count, least_scale));
  return fmax(size, relative_size(seed->parameter, instance->parameter, lagrangian.parameter_count, least_scale));
}

/*
 * Computes the start from the values that were set, displaced by step along the seed. False if there is none. set:
 * workspace of state_count numbers. Sets *is_moved if the start moves the states.
 */
static bool find_displaced(struct Instance *instance, const struct Seed *seed, double step, double *set,
                           bool *is_moved) {
  memcpy(instance->fmu_state, instance->given, fmu_state_size());
  instance->fmu_state->time += step * seed->time;
  for (size_t i = 0; i < lagrangian.state_count; i++) instance->state[i] += step * seed->state[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) instance->input[i] += step * seed->input[i];
  for (size_t i = 0; i < lagrangian.parameter_count; i++) instance->parameter[i] += step * seed->parameter[i];
  size_t size = lagrangian.state_count * sizeof *set;
  memcpy(set, instance->state, size);
  bool is_found = start_find(instance) == STATUS_DONE;
  *is_moved |= memcmp(set, instance->state, size) != 0;
  return is_found;
}

/* The derivative of the start along a seed, by differences. */
struct Slope {
  double *along;              /* state_count */
  double *bend;               /* state_count: the second difference */
  double *set;                /* state_count: workspace */
  bool is_moved;              /* a start differs from the states that were set */
  bool exists;                /* all displaced starts exist */
  char other[MESSAGE_LENGTH]; /* the element that has another mode in a displaced start; empty for none */
};

/* Names the first element whose mode differs from that in another snapshot, unless there is a name already. */
static void name_other_mode(const struct Instance *instance, const struct FmuState *fmu_state, char *name) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches == NULL || name[0] != '\0') return;
  const double *mode = instance->parameter;
  const double *other = fmu_state->values + (instance->parameter - instance->fmu_state->values);
  for (size_t i = 0; i < switches->contact_count && name[0] == '\0'; i++)
    if (mode[switches->contacts[i].mode] != other[switches->contacts[i].mode])
      snprintf(name, MESSAGE_LENGTH, "'%s'", switches->contacts[i].name);
  for (size_t i = 0; i < switches->friction_count && name[0] == '\0'; i++)
    if (mode[switches->frictions[i].mode] != other[switches->frictions[i].mode])
      snprintf(name, MESSAGE_LENGTH, "'%s'", switches->frictions[i].name);
  for (size_t i = 0; i < switches->branch_count && name[0] == '\0'; i++)
    if (mode[switches->branches[i].mode] != other[switches->branches[i].mode])
      snprintf(name, MESSAGE_LENGTH, "%s on line %ld of %s", switches->branches[i].function, switches->branches[i].line,
               switches->branches[i].file);
}

/* Computes central difference quotients of fourth order about the start; the snapshot is then undefined. */
static bool find_differences(struct Instance *instance, const struct Seed *seed, double step,
                             const struct FmuState *start, struct Slope *slope) {
  static const double weight[] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0};
  static const double bending[] = {0.0, 1.0, 1.0, 0.0};
  static const double at[] = {-2.0, -1.0, 1.0, 2.0};
  memset(slope->along, 0, lagrangian.state_count * sizeof *slope->along);
  memset(slope->bend, 0, lagrangian.state_count * sizeof *slope->bend);
  slope->other[0] = '\0';
  slope->is_moved = memcmp(start->values, instance->given->values, lagrangian.state_count * sizeof *slope->set) != 0;
  for (size_t j = 0; j < sizeof at / sizeof *at; j++) {
    if (!find_displaced(instance, seed, at[j] * step, slope->set, &slope->is_moved)) return false;
    name_other_mode(instance, start, slope->other);
    for (size_t i = 0; i < lagrangian.state_count; i++) {
      slope->along[i] += weight[j] * instance->state[i] / step;
      slope->bend[i] += bending[j] * (instance->state[i] - start->values[i]) / step;
    }
  }
  return true;
}

/* True if no state has a kink or a jump at the start. */
static bool is_smooth(const struct Slope *slope, const double *state, double size) {
  bool is = true;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    is &= fabs(slope->bend[i]) <= straight * size * scale_of(state, i);
  return is;
}

/* Finds the slope of the start kept along a seed of this size. True if it exists and is smooth. */
static bool find_slope(struct Instance *instance, const struct Seed *seed, double size, const struct FmuState *kept,
                       struct Slope *slope) {
  bool is_found = false;
  for (size_t k = 0; k < sizeof displacement / sizeof *displacement && !is_found; k++) {
    slope->exists = find_differences(instance, seed, displacement[k] / size, kept, slope);
    is_found = slope->exists && is_smooth(slope, kept->values, size);
  }
  return is_found;
}

/*
 * Replaces state by the directional derivative of the start, unless it moves no states. kept: workspace of
 * fmu_state_size() bytes. False if the start has none; slope->other then names the cause, if it is known.
 */
static bool find_along(struct Instance *instance, const struct Seed *seed, double *state, struct FmuState *kept,
                       struct Slope *slope) {
  struct Log log = instance->log;
  double size = size_of_seed(instance, seed, 1.0), size_by_values = size_of_seed(instance, seed, 0.0);
  bool is_found = size == 0.0;
  memcpy(kept, instance->fmu_state, fmu_state_size());
  instance->log.wanted = 0;
  if (!is_found) is_found = find_slope(instance, seed, size, kept, slope);
  if (!is_found && !slope->exists && size_by_values > size)
    is_found = find_slope(instance, seed, size_by_values, kept, slope);
  if (is_found && slope->is_moved) memcpy(state, slope->along, lagrangian.state_count * sizeof *state);
  instance->log = log;
  memcpy(instance->fmu_state, kept, fmu_state_size());
  instance->parameter_constants_are_stale = instance->modes_stay = true;
  return is_found;
}

static enum Status discard_kink(struct Instance *instance, const struct Slope *slope) {
  if (!slope->exists)
    return discard_call(instance, "the simulation cannot start near these start values; expected others");
  bool is_known = slope->other[0] != '\0';
  return discard_call(instance, "there is no derivative at these start values: beside them %s%s; expected others",
                      is_known ? slope->other : "an impact or event leads to other states",
                      is_known ? " starts in another mode" : "");
}

enum Status reading_follow_start(struct Instance *instance, const struct Seed *seed, double *state) {
  bool is_moved =
      instance->is_reading && instance->shown_is_found && instance->fmu_state->phase == PHASE_INITIALIZATION;
  if (!is_moved) return STATUS_DONE;
  struct Slope slope = {.along = instance->memory.allocate(3 * lagrangian.state_count, sizeof *slope.along)};
  struct FmuState *kept = instance->memory.allocate(1, fmu_state_size());
  bool has_memory = slope.along != NULL && kept != NULL;
  if (has_memory) slope.bend = slope.along + lagrangian.state_count;
  if (has_memory) slope.set = slope.bend + lagrangian.state_count;
  bool is_found = has_memory && find_along(instance, seed, state, kept, &slope);
  if (slope.along != NULL) instance->memory.free(slope.along);
  if (kept != NULL) instance->memory.free(kept);
  if (!has_memory) return reject_call(instance, "out of memory for the derivatives");
  return is_found ? STATUS_DONE : discard_kink(instance, &slope);
}
