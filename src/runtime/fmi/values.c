#include "fmi/values.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "fmi/check.h"
#include "instance/initial_state.h"
#include "stepping/reading.h"

static enum Status worse(enum Status first, enum Status second) {
  return first > second ? first : second;
}

/* True if the reported value of a variable may differ from the one that was set. */
static bool follows_start(unsigned reference) {
  if (reference >= lagrangian.variable_count) return false;
  enum VariableKind kind = lagrangian.variables[reference].kind;
  return kind != VARIABLE_TIME && kind != VARIABLE_INPUT && kind != VARIABLE_PARAMETER && kind != VARIABLE_STATISTIC;
}

/* Starts reading, up to reading_end(), if a variable needs it. */
static void begin_reading(struct Instance *instance, const unsigned *reference, size_t count) {
  bool any = false;
  for (size_t i = 0; i < count; i++) any |= follows_start(reference[i]);
  if (any) reading_begin(instance);
}

static enum Status get_values(struct Instance *instance, const unsigned *reference, size_t count, double *value) {
  enum Status status = STATUS_DONE;
  for (size_t i = 0; i < count; i++)
    if (check_reference(instance, reference[i], TYPE_REAL) == NULL) return STATUS_ERROR;
  for (size_t i = 0; i < count; i++)
    status = worse(status, evaluate_variable(instance, &lagrangian.variables[reference[i]], &value[i]));
  return status;
}

enum Status values_get(struct Instance *instance, const unsigned *reference, size_t count, double *value) {
  begin_reading(instance, reference, count);
  enum Status status = get_values(instance, reference, count, value);
  reading_end(instance);
  return status;
}

static enum Status get_whole_values(struct Instance *instance, const unsigned *reference, size_t count, int *value,
                                    enum VariableType type) {
  for (size_t i = 0; i < count; i++) {
    const struct ScalarVariable *variable = check_reference(instance, reference[i], type);
    if (variable == NULL) return STATUS_ERROR;
    bool is_contact = variable->kind == VARIABLE_CONTACT;
    if (is_contact) evaluate_prepare(instance); /* before the start the contact follows from the state */
    if (is_contact || variable->kind == VARIABLE_PARAMETER) value[i] = (int)instance->parameter[variable->index];
    else {
      int64_t statistic = instance->fmu_state->statistics[variable->index];
      value[i] = statistic < INT_MAX ? (int)statistic : INT_MAX;
    }
  }
  return STATUS_DONE;
}

enum Status values_get_whole(struct Instance *instance, const unsigned *reference, size_t count, int *value,
                             enum VariableType type) {
  begin_reading(instance, reference, count);
  enum Status status = get_whole_values(instance, reference, count, value, type);
  reading_end(instance);
  return status;
}

enum Status values_get_counts(struct Instance *instance, const unsigned *reference, size_t count, int64_t *value) {
  /* Discrete variables change only in event mode, if the importer uses it (FMI 3.0.2, section 2.4.7). */
  const struct FmuState *fmu_state = instance->fmu_state;
  const int64_t *counts = instance->uses_event_mode ? fmu_state->reported_statistics : fmu_state->statistics;
  for (size_t i = 0; i < count; i++) {
    const struct ScalarVariable *variable = check_reference(instance, reference[i], TYPE_INTEGER);
    if (variable == NULL) return STATUS_ERROR;
    if (variable->kind != VARIABLE_STATISTIC)
      return reject_call(instance, "'%s' is not of the type Int64", variable->name);
    value[i] = counts[variable->index];
  }
  return STATUS_DONE;
}

enum Status values_none(void *component, enum FunctionClass function, size_t count, const char *name) {
  struct Instance *instance = enter(component, function, name);
  if (instance == NULL) return STATUS_ERROR;
  return count == 0 ? STATUS_DONE : reject_call(instance, "the FMU has no variables of this type");
}

/* True if the importer integrates, and sets states at any time. Some importers set them one by one, as variables. */
static bool is_exchanged(const struct Instance *instance) {
  return instance->fmu_state->phase == PHASE_CONTINUOUS_TIME;
}

/* True for a state that the importer may change at events: a sensitivity, of which the FMU does not know the jump. */
static bool is_sensitivity(const struct ScalarVariable *variable) {
  size_t n = lagrangian.coordinate_count, first = n - lagrangian.sensitivity_count, state = variable->index;
  if (variable->kind != VARIABLE_STATE) return false;
  return state < 2 * n ? state % n >= first : state >= lagrangian.state_count - lagrangian.state_sensitivity_count;
}

static bool is_sensitivity_at_event(const struct Instance *instance, const struct ScalarVariable *variable) {
  return instance->fmu_state->phase == PHASE_EVENT && is_sensitivity(variable);
}

/* True for a state that the importer may change at an event, since the FMU does not (FMI 3.0.2, section 2.3.6). */
static bool is_free_at_event(const struct Instance *instance, const struct ScalarVariable *variable) {
  return instance->fmu_state->phase == PHASE_EVENT && instance->kind == KIND_MODEL_EXCHANGE &&
         variable->kind == VARIABLE_STATE && !variable->is_reinitialized;
}

/* True if variables of this kind may be set now. */
static bool is_settable(const struct Instance *instance, const struct ScalarVariable *variable) {
  int32_t phase = instance->fmu_state->phase;
  switch (variable->kind) {
  case VARIABLE_INPUT: return true;
  case VARIABLE_PARAMETER: return phase != PHASE_CONTINUOUS_TIME && phase != PHASE_INPUT_REQUEST;
  case VARIABLE_MODE: return is_before_start(instance);
  case VARIABLE_STATE:
    return is_before_start(instance) || is_exchanged(instance) || is_sensitivity_at_event(instance, variable) ||
           is_free_at_event(instance, variable);
  default: return false;
  }
}

static enum Status reject_calculated(struct Instance *instance, const struct ScalarVariable *variable) {
  if (*variable->follows_from == '\0')
    return reject_call(instance, "'%s' is calculated and cannot be set", variable->name);
  return reject_call(instance, "'%s' is calculated from other parameters (%s) and cannot be set; set those instead",
                     variable->name, variable->follows_from);
}

static enum Status reject_range(struct Instance *instance, const struct ScalarVariable *variable, double value) {
  bool is_below = value < variable->minimum;
  return discard_call(instance, "%g for '%s' is %s, %g", value, variable->name,
                      is_below ? "below its minimum" : "above its maximum",
                      is_below ? variable->minimum : variable->maximum);
}

/* Relative error of values that importers compute: a few thousand rounding errors, as of tables and ramps. */
static const double computed_error = 1e-12;

/* Returns the scale of a variable: the largest of its limits, its start value and the earlier values of an input. */
static double scale_of_variable(const struct Instance *instance, const struct ScalarVariable *variable) {
  double scale = fabs(variable->start);
  if (isfinite(variable->minimum)) scale = fmax(scale, fabs(variable->minimum));
  if (isfinite(variable->maximum)) scale = fmax(scale, fabs(variable->maximum));
  if (variable->kind != VARIABLE_INPUT) return scale;
  scale = fmax(scale, instance->largest_input[variable->index]);
  return scale > 0.0 ? scale : 1.0; /* an input that was 0 until now, and whose limit is 0 */
}

/* Returns a value, moved to the limit that it exceeds by no more than the error of computed values. */
static double within_limits(const struct Instance *instance, const struct ScalarVariable *variable, double value) {
  bool is_below = value < variable->minimum;
  if (!is_below && !(value > variable->maximum)) return value;
  double limit = is_below ? variable->minimum : variable->maximum;
  return fabs(value - limit) <= computed_error * scale_of_variable(instance, variable) ? limit : value;
}

static enum Status check_value(struct Instance *instance, unsigned reference, double value, enum VariableType type) {
  const struct ScalarVariable *variable = check_reference(instance, reference, type);
  if (variable == NULL) return STATUS_ERROR;
  if (is_calculated_parameter(variable)) return reject_calculated(instance, variable);
  if (!is_settable(instance, variable))
    return reject_call(instance, "'%s' cannot be set in the state '%s'", variable->name, instance_phase_name(instance));
  if (!isfinite(value))
    return discard_call(instance, "the value for '%s' is %g; expected a finite number", variable->name, value);
  if (type == TYPE_BOOLEAN && value != 0.0 && value != 1.0)
    return reject_call(instance, "the value for '%s' is %g; expected true or false, which are 1 and 0", variable->name,
                       value);
  value = within_limits(instance, variable, value);
  if (value < variable->minimum || value > variable->maximum) return reject_range(instance, variable, value);
  return STATUS_DONE;
}

/* Drops the derivatives that were set for an earlier step; those for the next step stay. */
static void end_polynomial(struct Instance *instance, size_t input) {
  if (instance->fmu_state->input_derivatives_set) return;
  for (size_t order = 0; order < INPUT_ORDER; order++)
    instance->input_derivatives[order * lagrangian.input_count + input] = 0.0;
}

static void set_value(struct Instance *instance, const struct ScalarVariable *variable, double value) {
  value = within_limits(instance, variable, value);
  if (variable->kind == VARIABLE_INPUT) {
    end_polynomial(instance, variable->index);
    instance->largest_input[variable->index] = fmax(instance->largest_input[variable->index], fabs(value));
  }
  if (variable->kind == VARIABLE_STATE && is_exchanged(instance)) {
    instance->state[variable->index] = value;
    return;
  }
  if (is_sensitivity_at_event(instance, variable)) {
    instance->state[variable->index] = value;
    if (instance->fmu_state->changed == CHANGED_NOTHING) instance->fmu_state->changed = CHANGED_COURSE;
    return;
  }
  if (is_before_start(instance)) initial_state_set(instance, variable);
  double *target = variable->kind == VARIABLE_INPUT   ? &instance->input[variable->index]
                   : variable->kind == VARIABLE_STATE ? &instance->state[variable->index]
                                                      : &instance->parameter[variable->index];
  if (*target == value) return;
  *target = value;
  instance->fmu_state->changed = CHANGED_VALUES;
  if (instance->fmu_state->update == UPDATE_DONE) instance->fmu_state->update = UPDATE_BEFORE_CHANGE;
  if (variable->kind != VARIABLE_INPUT && variable->kind != VARIABLE_STATE)
    instance->parameter_constants_are_stale = true;
}

static double number_of_type(const void *value, size_t index, enum VariableType type) {
  return type == TYPE_REAL ? ((const double *)value)[index] : ((const int *)value)[index];
}

enum Status values_set(struct Instance *instance, const unsigned *reference, size_t count, const void *value,
                       enum VariableType type) {
  enum Status status = STATUS_DONE;
  for (size_t i = 0; i < count; i++)
    status = worse(status, check_value(instance, reference[i], number_of_type(value, i, type), type));
  if (status != STATUS_DONE) return status;
  for (size_t i = 0; i < count; i++)
    set_value(instance, &lagrangian.variables[reference[i]], number_of_type(value, i, type));
  if (is_before_start(instance)) initial_state_follow(instance);
  return STATUS_DONE;
}

static enum Status check_input_derivative(struct Instance *instance, unsigned reference, int order, double value) {
  const struct ScalarVariable *variable = check_reference(instance, reference, TYPE_REAL);
  if (variable == NULL) return STATUS_ERROR;
  if (variable->kind != VARIABLE_INPUT) return reject_call(instance, "'%s' is not an input", variable->name);
  if (order < 1)
    return reject_call(instance, "the order %d for '%s' is out of range; expected 1 or more", order, variable->name);
  if (!isfinite(value))
    return reject_call(instance, "the value for '%s' is %g; expected a finite number", variable->name, value);
  return STATUS_DONE;
}

static enum Status ignore_input_derivative(const struct Instance *instance, const struct ScalarVariable *variable,
                                           int order) {
  log_message(instance, STATUS_WARNING,
              "%s: the derivative %d of '%s' is ignored, since an input is a polynomial of degree %d over a step; "
              "expected orders up to %d",
              instance->function, order, variable->name, INPUT_ORDER, INPUT_ORDER);
  return STATUS_WARNING;
}

enum Status values_set_input_derivatives(struct Instance *instance, const unsigned *reference, size_t count,
                                         const int *order, const double *value) {
  for (size_t i = 0; i < count; i++)
    if (check_input_derivative(instance, reference[i], order[i], value[i]) != STATUS_DONE) return STATUS_ERROR;
  size_t inputs = lagrangian.input_count;
  if (!instance->fmu_state->input_derivatives_set)
    memset(instance->input_derivatives, 0, INPUT_ORDER * inputs * sizeof *instance->input_derivatives);
  enum Status status = STATUS_DONE;
  for (size_t i = 0; i < count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[reference[i]];
    if (order[i] <= INPUT_ORDER)
      instance->input_derivatives[(size_t)(order[i] - 1) * inputs + variable->index] = value[i];
    else status = worse(status, ignore_input_derivative(instance, variable, order[i]));
  }
  instance->fmu_state->input_derivatives_set = 1;
  instance->fmu_state->changed = CHANGED_VALUES;
  return status;
}
