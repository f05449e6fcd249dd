/*
 * Serialized state of an instance: a header, and then its snapshot (struct FmuState), a block of bytes without
 * pointers. The bytes are those of the machine; another process on a machine of the same kind may restore them.
 *
 * snapshot_fault() checks bytes before they are restored. The header must show the same FMU and version, and the
 * checksum of the snapshot. Then each field must be in the range in which an instance can leave it. Anyone can compute
 * the checksum of a forged block, which could otherwise make the instance index out of bounds. A check costs O(size).
 */
#include "instance/snapshot.h"

#include <math.h>
#include <string.h>

#include "instance/solver.h"

/* Header of a block. */
struct Header {
  char magic[8];
  uint32_t version;
  uint32_t size; /* bytes of the snapshot */
  char guid[40];
  uint64_t checksum; /* of the snapshot */
};

static const char magic[8] = {'l', 'a', 'g', 'r', 'a', 'n', 'g', 'e'};
/* Version of the layout of snapshots; a change of struct FmuState or of a solver's part raises it. */
enum { VERSION = 12 };

size_t snapshot_size(void) {
  return sizeof(struct Header) + fmu_state_size();
}

static struct Header header_of(const void *fmu_state) {
  struct Header header = {.version = VERSION, .size = (uint32_t)fmu_state_size()};
  memcpy(header.magic, magic, sizeof magic);
  strncpy(header.guid, lagrangian.guid, sizeof header.guid - 1);
  header.checksum = instance_checksum(fmu_state, fmu_state_size());
  return header;
}

bool snapshot_are_counts(const int64_t *counts, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (counts[i] < 0 || counts[i] > INT64_MAX / 2) return false;
  return true;
}

/* Returns element index of an array of doubles at any alignment. */
static double number_in(const char *bytes, size_t index) {
  double number;
  memcpy(&number, bytes + index * sizeof number, sizeof number);
  return number;
}

bool snapshot_is_finite(const void *numbers, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(number_in(numbers, i))) return false;
  return true;
}

/* True if an instance of this kind can be in the phase. */
static bool has_phase(const struct Instance *instance, int32_t phase) {
  bool of_exchange = phase == PHASE_EVENT || phase == PHASE_CONTINUOUS_TIME;
  bool of_steps = phase == PHASE_STEP_COMPLETE || phase == PHASE_STEP_FAILED;
  if (phase == PHASE_EVENT && instance->uses_event_mode) return true;
  return phase >= 0 && phase < PHASE_INTERMEDIATE_UPDATE &&
         !(instance->kind == KIND_MODEL_EXCHANGE ? of_steps : of_exchange);
}

/* Returns the largest count of events within rounding that a state may have. */
static int32_t most_close_events(void) {
  return 100 + (lagrangian.switches != NULL ? (int32_t)indicator_count(lagrangian.switches) : 0);
}

static bool can_wait(const struct Instance *instance, const struct FmuState *fixed) {
  if (fixed->close_events < 0 || fixed->close_events > most_close_events()) return false;
  if (fixed->waiting_event == 0) return true;
  return instance->uses_event_mode && fixed->waiting_event > 0 &&
         (size_t)fixed->waiting_event <= indicator_count(lagrangian.switches);
}

/*
 * True if the states and the parameters are finite. Before the simulation, states and modes may be undefined if
 * start values follow from parameters.
 */
static bool are_values(int32_t phase, const char *states, const char *parameters) {
  bool is_early = phase == PHASE_INSTANTIATED || phase == PHASE_INITIALIZATION || phase == PHASE_ERROR;
  bool may_be_undefined = is_early && lagrangian.following_count > 0;
  size_t modes = may_be_undefined && lagrangian.switches != NULL ? lagrangian.switches->mode_count : 0;
  return (may_be_undefined || snapshot_is_finite(states, lagrangian.state_count)) &&
         snapshot_is_finite(parameters, lagrangian.parameter_count - modes);
}

/* True if the flags and enums are in their ranges. */
static bool are_choices(const struct FmuState *fixed) {
  const int32_t flags[] = {fixed->experiment_defined, fixed->stop_time_defined, fixed->input_derivatives_set};
  for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
    if (flags[i] != 0 && flags[i] != 1) return false;
  int64_t most_redundant = lagrangian.constraints.projection != NULL ? 1 : 0;
  if (fixed->has_redundant < 0 || fixed->has_redundant > most_redundant) return false;
  return fixed->changed >= CHANGED_NOTHING && fixed->changed <= CHANGED_COURSE && fixed->update >= UPDATE_MISSING &&
         fixed->update <= UPDATE_DONE;
}

/* True if the element is an integer from lowest to highest. */
static bool is_whole(const char *numbers, size_t index, double lowest, double highest) {
  double number = number_in(numbers, index);
  return number == floor(number) && number >= lowest && number <= highest;
}

/* True if each of the numbers is 0 or 1. */
static bool are_flags(const void *numbers, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double flag = number_in(numbers, i);
    if (flag != 0.0 && flag != 1.0) return false;
  }
  return true;
}

/* True if the values of Integer and Boolean parameters fit their types. */
static bool have_types(const char *parameters) {
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (variable->kind != VARIABLE_PARAMETER || variable->type == TYPE_REAL) continue;
    bool is_flag = variable->type == TYPE_BOOLEAN;
    if (!is_whole(parameters, variable->index, is_flag ? 0.0 : INT32_MIN, is_flag ? 1.0 : INT32_MAX)) return false;
  }
  return true;
}

/* True if the modes that only events set are in their ranges. */
static bool are_modes(const char *parameters) {
  const struct SwitchTable *switches = lagrangian.switches;
  if (switches == NULL) return true;
  for (size_t i = 0; i < switches->branch_count; i++)
    if (!is_whole(parameters, switches->branches[i].mode, -1.0, 1.0)) return false;
  for (size_t i = 0; i < switches->contact_count; i++)
    if (!is_whole(parameters, switches->contacts[i].mode, 0.0, 1.0)) return false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool is_of_two = is_in_plane(switches, i);
    double lowest = is_of_two ? PLANE_IS_FREE : -1.0, highest = is_of_two ? PLANE_CREEPS : 1.0;
    if (!is_whole(parameters, switches->frictions[i].mode, lowest, highest)) return false;
  }
  for (size_t i = 0; i < switches->resting_count; i++)
    if (!is_whole(parameters, switches->resting[i].mode, VELOCITY_RESTS, VELOCITY_ACCELERATES)) return false;
  return true;
}

/* True if the solver could have saved its part, which only co-simulation uses. */
static bool is_solver_part_valid(const struct Instance *instance, const struct FmuState *fixed, const char *saved) {
  const struct Solver *solver = lagrangian.solver;
  return instance->kind == KIND_MODEL_EXCHANGE || solver == NULL || solver->is_saved_valid == NULL ||
         solver->is_saved_valid(fixed, saved);
}

/*
 * True if an instance could have saved the snapshot. fixed: an aligned copy of its fixed part. An input may be
 * infinite, at the end of a polynomial; results that depend on it are discarded.
 */
static bool is_possible(const struct Instance *instance, const struct FmuState *fixed, const char *fmu_state) {
  const double numbers[] = {fixed->time,          fixed->start_time,     fixed->stop_time,
                            fixed->tolerance,     fixed->suggested_step, fixed->last_step.start,
                            fixed->last_step.end, fixed->searched,       fixed->switched};
  size_t parameters = (size_t)((char *)instance->parameter - (char *)instance->fmu_state);
  size_t saved = (size_t)((char *)instance->saved - (char *)instance->fmu_state);
  size_t was_set = (size_t)((char *)instance->start_was_set - (char *)instance->fmu_state);
  return has_phase(instance, fixed->phase) && are_choices(fixed) && can_wait(instance, fixed) &&
         snapshot_are_counts(fixed->statistics, STATISTIC_COUNT) &&
         snapshot_are_counts(fixed->reported_statistics, STATISTIC_COUNT) &&
         snapshot_are_counts(&fixed->completed_steps, 1) &&
         snapshot_is_finite(numbers, sizeof numbers / sizeof *numbers) && fixed->tolerance > 0.0 &&
         fixed->tolerance < 1.0 && fixed->suggested_step >= 0.0 && fixed->last_step.start <= fixed->last_step.end &&
         fixed->searched <= fixed->last_step.end &&
         are_values(fixed->phase, fmu_state + sizeof *fixed, fmu_state + parameters) &&
         are_flags(fmu_state + was_set, (saved - was_set) / sizeof(double)) && have_types(fmu_state + parameters) &&
         are_modes(fmu_state + parameters) && is_solver_part_valid(instance, fixed, fmu_state + saved);
}

const char *snapshot_fault(const struct Instance *instance, const void *block, size_t size) {
  struct Header header;
  if (size < sizeof header) return "they are cut off";
  memcpy(&header, block, sizeof header);
  if (memcmp(header.magic, magic, sizeof magic) != 0) return "they are not a state of this FMU";
  if (header.version != VERSION) return "they come from another version";
  if (strncmp(header.guid, lagrangian.guid, sizeof header.guid) != 0) return "they come from another model";
  if (size != snapshot_size()) return "they have another length";
  const char *fmu_state = (const char *)block + sizeof header;
  struct Header expected = header_of(fmu_state);
  struct FmuState fixed;
  memcpy(&fixed, fmu_state, sizeof fixed);
  if (memcmp(&header, &expected, sizeof header) != 0) return "they are damaged";
  if (fixed.kind != (int32_t)instance->kind)
    return "they come from an instance of the other kind, model exchange or co-simulation";
  return is_possible(instance, &fixed, fmu_state) ? NULL : "they contain values that no instance can have saved";
}

void snapshot_take(const struct Instance *instance, void *block) {
  struct Header header = header_of(instance->fmu_state);
  memcpy(block, &header, sizeof header);
  memcpy((char *)block + sizeof header, instance->fmu_state, fmu_state_size());
}

void snapshot_restore(struct Instance *instance, const void *block) {
  instance_restore(instance, (const char *)block + sizeof(struct Header));
}
