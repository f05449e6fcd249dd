#include "stepping/reading.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "stepping/start.h"

/* True if the reported values may differ from the stored state. */
static bool may_differ(const struct Instance *instance) {
  const struct Situation *situation = instance->situation;
  if (instance->shown == NULL) return false; /* nothing moves the values that were set */
  if (situation->phase == PHASE_INITIALIZATION) return true;
  return lagrangian.event_laws != NULL && situation->phase == PHASE_STEP_COMPLETE &&
         situation->changed == CHANGED_VALUES;
}

static void exchange_situations(struct Instance *instance) {
  struct Situation *other = instance->shown;
  instance->shown = instance->situation;
  instance_use(instance, other);
  instance->prepared_is_stale = true;
}

/* Receives messages; keeps the first one. */
static void keep_message(void *receiver, enum Status status, const char *message) {
  char *text = receiver;
  (void)status;
  if (text[0] == '\0') strncat(text, message, MESSAGE_LENGTH - 1);
}

static void tell_impossible_start(struct Instance *instance, const char *reason) {
  if (instance->told_impossible_start) return;
  log_message(instance, STATUS_WARNING,
              "values in initialization mode are those that were set, since there is no consistent start: %s", reason);
  instance->told_impossible_start = true;
}

/* Computes the reported values on the copy, without messages: the function that starts there will report failures. */
static void find_silently(struct Instance *instance) {
  char reason[MESSAGE_LENGTH] = "";
  struct Log log = instance->log;
  uint64_t told_singularity = instance->told_singularity;
  bool starts = instance->situation->phase == PHASE_INITIALIZATION;
  instance->log = (struct Log){keep_message, reason, 1u << STATUS_DISCARD | 1u << STATUS_ERROR};
  if (starts) instance->shown_is_found = start_find(instance) == STATUS_DONE;
  else instance->shown_is_found = evaluate_prepare(instance) == STATUS_DONE && start_step(instance);
  instance->log = log;
  instance->told_singularity = told_singularity;
  if (instance->shown_is_found) return;
  memcpy(instance->situation, instance->given, situation_size());
  if (starts) tell_impossible_start(instance, reason);
}

void reading_begin(struct Instance *instance) {
  if (!may_differ(instance)) return;
  bool is_new = memcmp(instance->given, instance->situation, situation_size()) != 0;
  if (is_new) memcpy(instance->given, instance->situation, situation_size());
  if (is_new || !instance->shown_is_found) memcpy(instance->shown, instance->situation, situation_size());
  exchange_situations(instance);
  if (is_new) find_silently(instance);
  instance->modes_stay = instance->shown_is_found;
  instance->prepared_is_stale = true;
  instance->is_reading = true;
}

void reading_end(struct Instance *instance) {
  if (!instance->is_reading) return;
  bool failed = instance->situation->phase == PHASE_ERROR;
  exchange_situations(instance);
  instance->is_reading = instance->modes_stay = false;
  if (!failed) return;
  instance->shown->phase = instance->situation->phase;
  instance->situation->phase = PHASE_ERROR;
}

/* Displacement of the difference quotients, in units of the scales. The relative truncation error is about 1e-12. */
static const double displacement = 1e-3;

/* Returns the largest of count values relative to the variables that they change, at least 1. */
static double relative_size(const double *value, const double *of, size_t count) {
  double largest = 0.0;
  for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(value[i]) / fmax(fabs(of[i]), 1.0));
  return largest;
}

static double size_of_seed(const struct Instance *instance, const struct Seed *seed) {
  double size = fabs(seed->time);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    size = fmax(size, fabs(seed->state[i]) / scale_of(instance->state, i));
  size = fmax(size, relative_size(seed->input, instance->input, lagrangian.input_count));
  return fmax(size, relative_size(seed->parameter, instance->parameter, lagrangian.parameter_count));
}

/* Computes the start from the values that were set, displaced by step along the seed. False if there is none. */
static bool find_displaced(struct Instance *instance, const struct Seed *seed, double step) {
  memcpy(instance->situation, instance->given, situation_size());
  instance->situation->time += step * seed->time;
  for (size_t i = 0; i < lagrangian.state_count; i++) instance->state[i] += step * seed->state[i];
  for (size_t i = 0; i < lagrangian.input_count; i++) instance->input[i] += step * seed->input[i];
  for (size_t i = 0; i < lagrangian.parameter_count; i++) instance->parameter[i] += step * seed->parameter[i];
  return start_find(instance) == STATUS_DONE;
}

/* Adds the central difference quotient of fourth order to along[state_count]; the state is then undefined. */
static bool add_differences(struct Instance *instance, const struct Seed *seed, double step, double *along) {
  static const double weight[] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0};
  static const double at[] = {-2.0, -1.0, 1.0, 2.0};
  for (size_t j = 0; j < sizeof at / sizeof *at; j++) {
    if (!find_displaced(instance, seed, at[j] * step)) return false;
    for (size_t i = 0; i < lagrangian.state_count; i++) along[i] += weight[j] * instance->state[i] / step;
  }
  return true;
}

/* Computes the directional derivative of the start. Workspace: kept of situation_size() bytes, along of zeros. */
static bool find_along(struct Instance *instance, const struct Seed *seed, double *state, struct Situation *kept,
                       double *along) {
  struct Log log = instance->log;
  double size = size_of_seed(instance, seed);
  if (size == 0.0) return true;
  memcpy(kept, instance->situation, situation_size());
  instance->log.wanted = 0;
  bool is_found = add_differences(instance, seed, displacement / size, along);
  instance->log = log;
  memcpy(instance->situation, kept, situation_size());
  instance->prepared_is_stale = true;
  if (is_found) memcpy(state, along, lagrangian.state_count * sizeof *state);
  return is_found;
}

/* Excludes systems with events: the modes of displaced starts may differ. */
enum Status reading_follow_start(struct Instance *instance, const struct Seed *seed, double *state) {
  bool is_moved = instance->is_reading && instance->shown_is_found && lagrangian.constraints.projection != NULL &&
                  lagrangian.event_laws == NULL && instance->situation->phase == PHASE_INITIALIZATION;
  if (!is_moved) return STATUS_DONE;
  double *along = instance->memory.allocate(lagrangian.state_count, sizeof *along);
  struct Situation *kept = instance->memory.allocate(1, situation_size());
  bool has_memory = along != NULL && kept != NULL;
  bool is_found = has_memory && find_along(instance, seed, state, kept, along);
  if (along != NULL) instance->memory.free(along);
  if (kept != NULL) instance->memory.free(kept);
  if (!has_memory) return refuse_call(instance, "out of memory for the derivatives");
  if (is_found) return STATUS_DONE;
  return discard_call(instance, "the simulation cannot start near these start values; expected others");
}
