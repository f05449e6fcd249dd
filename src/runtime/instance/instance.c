#include "instance/instance.h"

#include <math.h>
#include <string.h>

#include "instance/initial_state.h"
#include "instance/projection.h"
#include "instance/solver.h"
#include "instance/event_laws.h"
#include "support/arena.h"

/* Divides the values of a snapshot, without the solver's part behind them. */
static size_t lay_out_values(struct Instance *instance, double *values) {
  struct Arena arena = {(uintptr_t)values};
  ARENA_NUMBERS(&arena, lagrangian.state_count, &instance->state);
  ARENA_NUMBERS(&arena, lagrangian.input_count, &instance->input);
  ARENA_NUMBERS(&arena, lagrangian.parameter_count, &instance->parameter);
  ARENA_NUMBERS(&arena, INPUT_ORDER * lagrangian.input_count, &instance->input_derivatives);
  ARENA_NUMBERS(&arena, lagrangian.following_count, &instance->start_was_set);
  return arena.next - (uintptr_t)values;
}

size_t fmu_state_size(void) {
  struct Instance counted;
  bool saves = lagrangian.solver != NULL && lagrangian.solver->saved_size != NULL;
  return sizeof(struct FmuState) + lay_out_values(&counted, NULL) + (saves ? lagrangian.solver->saved_size() : 0);
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
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches != NULL && switches->importer < lagrangian.parameter_count)
    instance->parameter[switches->importer] = instance->kind == KIND_MODEL_EXCHANGE ? 1.0 : 0.0;
  memset(instance->largest_input, 0, lagrangian.input_count * sizeof *instance->largest_input);
  initial_state_follow(instance);
  instance->fmu_state->changed = CHANGED_VALUES;
  instance->parameter_constants_are_stale = instance->solver_is_stale = true;
  instance->reported_impossible_start = instance->reported_straight_input = false;
  instance->reported_other_forces = instance->reported_other_impulses = instance->reported_ended_slip = false;
  instance->reported_time_steps = instance->reported_slowness = false;
  instance->reported_singularity = 0;
  instance->departure_time = -INFINITY;
}

void instance_use(struct Instance *instance, struct FmuState *fmu_state) {
  instance->fmu_state = fmu_state;
  lay_out_values(instance, fmu_state->values);
  instance->saved = instance->start_was_set + lagrangian.following_count;
}

/* Divides the memory of evaluations. Systems without constraints find accelerations in the derivatives of the state. */
static size_t lay_out_evaluation(struct Instance *instance, void *block) {
  const struct Projection *constrained = lagrangian.constraints.projection;
  const struct EventLaws *events = lagrangian.event_laws;
  size_t states = lagrangian.state_count, rows = lagrangian.coordinate_count + lagrangian.constraints.count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_NUMBERS(&arena, lagrangian.parameter_constants_count, &instance->parameter_constants);
  ARENA_NUMBERS(&arena, lagrangian.work_count, &instance->point_work);
  ARENA_NUMBERS(&arena, lagrangian.following_count, &instance->start_work);
  instance->projection_work = arena_take(&arena, 1, constrained != NULL ? constrained->lay_out(NULL) : 0);
  ARENA_NUMBERS(&arena, constrained != NULL ? 2 * rows : 0, &instance->acceleration);
  ARENA_NUMBERS(&arena, events != NULL ? events->work_count() : 0, &instance->switching_work);
  ARENA_NUMBERS(&arena, events != NULL ? 2 * states : 0, &instance->event_state);
  ARENA_NUMBERS(&arena, lagrangian.input_count, &instance->largest_input);
  ARENA_NUMBERS(&arena, 3 * states + 2 * lagrangian.input_count + lagrangian.parameter_count + 1, &instance->work);
  return arena.next - (uintptr_t)block;
}

static void free_shown(const struct Instance *instance) {
  if (instance->given != NULL) instance->memory.free(instance->given);
  if (instance->shown != NULL) instance->memory.free(instance->shown);
}

bool instance_create(struct Instance *instance, enum InterfaceType kind, const struct Allocator *memory,
                     const struct Log *log) {
  *instance = (struct Instance){.memory = *memory, .log = *log, .kind = kind};
  bool shows = lagrangian.constraints.projection != NULL || lagrangian.event_laws != NULL;
  void *evaluation = memory->allocate(1, lay_out_evaluation(instance, NULL));
  struct FmuState *fmu_state = memory->allocate(1, fmu_state_size());
  if (shows) {
    instance->given = memory->allocate(1, fmu_state_size());
    instance->shown = memory->allocate(1, fmu_state_size());
  }
  bool has_shown = instance->given != NULL && instance->shown != NULL;
  if (fmu_state != NULL && evaluation != NULL && (!shows || has_shown)) {
    instance_use(instance, fmu_state);
    lay_out_evaluation(instance, evaluation);
    if (lagrangian.constraints.projection != NULL)
      lagrangian.constraints.projection->lay_out(instance->projection_work);
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
