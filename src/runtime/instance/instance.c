#include "instance/instance.h"

#include <string.h>

#include "instance/initial_state.h"
#include "instance/projection.h"
#include "instance/solver.h"
#include "instance/event_laws.h"

static size_t value_count(void) {
  return lagrangian.state_count + (1 + INPUT_ORDER) * lagrangian.input_count + lagrangian.parameter_count +
         lagrangian.following_count;
}

size_t fmu_state_size(void) {
  bool saves = lagrangian.solver != NULL && lagrangian.solver->saved_size != NULL;
  return sizeof(struct FmuState) + value_count() * sizeof(double) + (saves ? lagrangian.solver->saved_size() : 0);
}

/* Computes the 64-bit FNV-1a hash. */
uint64_t instance_checksum(const void *block, size_t size) {
  const unsigned char *bytes = block;
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * 0x100000001b3u;
  return hash;
}

void instance_reset(struct Instance *instance) {
  memset(instance->fmu_state, 0, fmu_state_size());
  instance->fmu_state->phase = PHASE_INSTANTIATED;
  instance->fmu_state->kind = (int32_t)instance->kind;
  instance->fmu_state->tolerance = lagrangian.steps.tolerance;
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (variable->kind == VARIABLE_STATE) instance->state[variable->index] = variable->start;
    if (variable->kind == VARIABLE_INPUT) instance->input[variable->index] = variable->start;
    if (variable->kind == VARIABLE_PARAMETER || variable->kind == VARIABLE_MODE)
      instance->parameter[variable->index] = variable->start;
  }
  memset(instance->largest_input, 0, lagrangian.input_count * sizeof *instance->largest_input);
  initial_state_follow(instance);
  instance->fmu_state->changed = CHANGED_VALUES;
  instance->parameter_constants_are_stale = instance->solver_is_stale = true;
  instance->reported_impossible_start = instance->reported_straight_input = false;
  instance->reported_other_forces = instance->reported_other_impulses = false;
  instance->reported_singularity = 0;
}

/* Accelerations and constraint forces for result(); systems without constraints use the derivatives of the state. */
static size_t acceleration_count(void) {
  return lagrangian.constraints.projection == NULL ? 0 : lagrangian.coordinate_count + lagrangian.constraints.count;
}

static size_t switching_work_count(void) {
  return lagrangian.event_laws != NULL ? lagrangian.event_laws->work_count() + 2 * lagrangian.state_count : 0;
}

static size_t evaluation_count(void) {
  return lagrangian.parameter_constants_count + lagrangian.work_count + lagrangian.following_count +
         projection_work_count() + switching_work_count() + 2 * acceleration_count() + 3 * lagrangian.state_count +
         3 * lagrangian.input_count + lagrangian.parameter_count + 1;
}

void instance_use(struct Instance *instance, struct FmuState *fmu_state) {
  instance->fmu_state = fmu_state;
  instance->state = instance->fmu_state->values;
  instance->input = instance->state + lagrangian.state_count;
  instance->parameter = instance->input + lagrangian.input_count;
  instance->input_derivatives = instance->parameter + lagrangian.parameter_count;
  instance->start_was_set = instance->input_derivatives + INPUT_ORDER * lagrangian.input_count;
  instance->saved = instance->start_was_set + lagrangian.following_count;
}

/* Divides a block of memory among the arrays. */
static void lay_out(struct Instance *instance, double *evaluation) {
  instance->parameter_constants = evaluation;
  instance->point_work = instance->parameter_constants + lagrangian.parameter_constants_count;
  instance->start_work = instance->point_work + lagrangian.work_count;
  instance->projection_work = instance->start_work + lagrangian.following_count;
  instance->switching_work = instance->projection_work + projection_work_count();
  instance->acceleration = instance->switching_work + switching_work_count();
  if (lagrangian.event_laws != NULL)
    instance->event_state = instance->switching_work + lagrangian.event_laws->work_count();
  instance->largest_input = instance->acceleration + 2 * acceleration_count();
  instance->work = instance->largest_input + lagrangian.input_count;
}

static void free_shown(const struct Instance *instance) {
  if (instance->given != NULL) instance->memory.free(instance->given);
  if (instance->shown != NULL) instance->memory.free(instance->shown);
}

bool instance_create(struct Instance *instance, enum InterfaceType kind, const struct Allocator *memory,
                     const struct Log *log) {
  *instance = (struct Instance){.memory = *memory, .log = *log, .kind = kind};
  bool shows = lagrangian.constraints.projection != NULL || lagrangian.event_laws != NULL;
  double *evaluation = memory->allocate(evaluation_count(), sizeof *evaluation);
  struct FmuState *fmu_state = memory->allocate(1, fmu_state_size());
  if (shows) {
    instance->given = memory->allocate(1, fmu_state_size());
    instance->shown = memory->allocate(1, fmu_state_size());
  }
  bool has_shown = instance->given != NULL && instance->shown != NULL;
  if (fmu_state != NULL && evaluation != NULL && (!shows || has_shown)) {
    instance_use(instance, fmu_state);
    lay_out(instance, evaluation);
    instance_reset(instance);
    return true;
  }
  if (fmu_state != NULL) memory->free(fmu_state);
  if (evaluation != NULL) memory->free(evaluation);
  free_shown(instance);
  return false;
}

void instance_destroy(struct Instance *instance) {
  if (instance->solver_memory != NULL) lagrangian.solver->destroy(instance);
  instance->memory.free(instance->parameter_constants);
  instance->memory.free(instance->fmu_state);
  free_shown(instance);
  scratch_free(instance);
}

void instance_restore(struct Instance *instance, const void *fmu_state) {
  memcpy(instance->fmu_state, fmu_state, fmu_state_size());
  instance->parameter_constants_are_stale = instance->solver_is_stale = true;
  instance->reported_singularity = 0;
}

const char *instance_phase_name(const struct Instance *instance) {
  static const char *const names[PHASE_COUNT] = {
      [PHASE_INSTANTIATED] = "instantiated",
      [PHASE_INITIALIZATION] = "initialization mode",
      [PHASE_EVENT] = "event mode",
      [PHASE_CONTINUOUS_TIME] = "continuous-time mode",
      [PHASE_STEP_COMPLETE] = "step complete",
      [PHASE_STEP_FAILED] = "step failed",
      [PHASE_TERMINATED] = "terminated",
      [PHASE_ERROR] = "error",
      [PHASE_INTERMEDIATE_UPDATE] = "intermediate update mode",
      [PHASE_INPUT_REQUEST] = "intermediate update mode for inputs",
  };
  return names[instance->fmu_state->phase];
}
