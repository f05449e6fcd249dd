/*
 * Exports the functions of FMI 3.0 as a WebAssembly component (FMI-LS-WASM). Lists and strings arrive as address and
 * count, in memory that then belongs to this module. Results other than single numbers are returned by address.
 * Layouts follow the Component Model's canonical ABI, which C structures have on wasm32. interface.py has the types of
 * all functions.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3.h"

#define EXPORT(name) __attribute__((export_name(name)))

struct AdapterInstance {
  fmi3Instance instance;
  char *name;
  size_t state_count, indicator_count; /* of model exchange, which FMI 3.0 does not report in continuous-time mode */
};

struct Text {
  char *characters;
  size_t count;
};

/* The result of a function: a value, or the status if it failed. */
struct ListResult {
  uint8_t failed;
  union {
    struct {
      void *items;
      size_t count;
    } list;
    uint8_t status;
  };
};

struct CountResult {
  uint8_t failed;
  union {
    uint64_t count;
    uint8_t status;
  };
};

struct Discrete {
  bool new_states_needed, terminates, nominals_changed, states_changed, has_next_event;
  double next_event;
};

struct Step {
  double last_successful_time;
  bool event_handling_needed, terminates, early_return;
};

struct CompletedStep {
  bool enter_event_mode, terminates;
};

struct Order {
  uint32_t reference, order;
};

/* --- Memory --- */

EXPORT("cabi_realloc") void *reallocate(void *old, size_t old_size, size_t alignment, size_t size) {
  (void)old_size;
  if (size == 0) return (void *)alignment; /* an empty list, which nobody reads or frees */
  void *memory = realloc(old, size);
  if (memory == NULL) __builtin_trap();
  return memory;
}

static void *allocate(size_t count, size_t size) {
  return reallocate(NULL, 0, 8, count * size);
}

static void discard(const void *list, size_t count) {
  if (count > 0) free((void *)list);
}

/* Returns a copy with a terminating zero; frees the text. */
static char *terminated(char *text, size_t count) {
  char *copy = allocate(count + 1, 1);
  memcpy(copy, text, count);
  copy[count] = '\0';
  discard(text, count);
  return copy;
}

/* --- Results --- */

static bool has_failed(fmi3Status status) {
  return status > fmi3Warning;
}

static struct ListResult *list_result(fmi3Status status, void *items, size_t count) {
  static struct ListResult result;
  result = (struct ListResult){.failed = has_failed(status)};
  if (result.failed) {
    discard(items, count);
    result.status = (uint8_t)status;
  } else {
    result.list.items = items;
    result.list.count = count;
  }
  return &result;
}

EXPORT("forget-list") void forget_list(struct ListResult *result) {
  if (!result->failed) discard(result->list.items, result->list.count);
}

static struct CountResult *count_result(fmi3Status status, size_t count) {
  static struct CountResult result;
  result = (struct CountResult){.failed = has_failed(status)};
  if (result.failed) result.status = (uint8_t)status;
  else result.count = count;
  return &result;
}

/* --- Instances --- */

__attribute__((import_module("callbacks"), import_name("log-message"))) void
report_to_host(const char *instance, size_t instance_count, int32_t status, const char *category, size_t category_count,
               const char *message, size_t message_count);

static void hand_on(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
  const char *name = environment;
  report_to_host(name, strlen(name), (int32_t)status, category, strlen(category), message, strlen(message));
}

static struct AdapterInstance *component_of(fmi3Instance instance, char *name) {
  if (instance == NULL) {
    free(name);
    return NULL;
  }
  struct AdapterInstance *component = allocate(1, sizeof *component);
  *component = (struct AdapterInstance){.instance = instance, .name = name};
  return component;
}

/* Both return NULL on failure. */
EXPORT("instantiate-co-simulation")
struct AdapterInstance *instantiate_co_simulation(char *name, size_t name_count, char *token, size_t token_count,
                                                  bool visible, bool logging_on, bool event_mode_used,
                                                  bool early_return_allowed, fmi3ValueReference *required, size_t n) {
  char *own_name = terminated(name, name_count), *own_token = terminated(token, token_count);
  fmi3Instance instance = fmi3InstantiateCoSimulation(own_name, own_token, NULL, visible, logging_on, event_mode_used,
                                                      early_return_allowed, required, n, own_name, hand_on, NULL);
  free(own_token);
  discard(required, n);
  return component_of(instance, own_name);
}

EXPORT("instantiate-model-exchange")
struct AdapterInstance *instantiate_model_exchange(char *name, size_t name_count, char *token, size_t token_count,
                                                   bool visible, bool logging_on) {
  char *own_name = terminated(name, name_count), *own_token = terminated(token, token_count);
  fmi3Instance instance =
      fmi3InstantiateModelExchange(own_name, own_token, NULL, visible, logging_on, own_name, hand_on);
  free(own_token);
  struct AdapterInstance *component = component_of(instance, own_name);
  if (component == NULL) return NULL;
  fmi3GetNumberOfContinuousStates(instance, &component->state_count);
  fmi3GetNumberOfEventIndicators(instance, &component->indicator_count);
  return component;
}

/* Returns the buffer of option<own<...>>: whether there is an instance, then its handle. */
EXPORT("place") void *place(void) {
  static uint32_t instance[2];
  return instance;
}

EXPORT("free-instance") void free_instance(struct AdapterInstance *self) {
  fmi3FreeInstance(self->instance);
  free(self->name);
  free(self);
}

EXPORT("get-version") struct Text *get_version(void) {
  static struct Text version;
  version.characters = (char *)fmi3GetVersion();
  version.count = strlen(version.characters);
  return &version;
}

EXPORT("set-debug-logging")
fmi3Status set_debug_logging(struct AdapterInstance *self, bool logging_on, struct Text *texts, size_t count) {
  char **categories = allocate(count, sizeof *categories);
  for (size_t i = 0; i < count; i++) categories[i] = terminated(texts[i].characters, texts[i].count);
  fmi3Status status = fmi3SetDebugLogging(self->instance, logging_on, count, (const char *const *)categories);
  for (size_t i = 0; i < count; i++) free(categories[i]);
  discard(categories, count);
  discard(texts, count);
  return status;
}

/* --- Transitions between states --- */

EXPORT("enter-initialization-mode")
fmi3Status enter_initialization_mode(struct AdapterInstance *self, bool has_tolerance, double tolerance,
                                     double start_time, bool has_stop_time, double stop_time) {
  return fmi3EnterInitializationMode(self->instance, has_tolerance, tolerance, start_time, has_stop_time, stop_time);
}

#define TRANSITION(name, function)                                                                                     \
  EXPORT(name) fmi3Status transition_##function(struct AdapterInstance *self) {                                        \
    return fmi3##function(self->instance);                                                                             \
  }
TRANSITION("exit-initialization-mode", ExitInitializationMode)
TRANSITION("enter-event-mode", EnterEventMode)
TRANSITION("enter-continuous-time-mode", EnterContinuousTimeMode)
TRANSITION("enter-step-mode", EnterStepMode)
TRANSITION("enter-configuration-mode", EnterConfigurationMode)
TRANSITION("exit-configuration-mode", ExitConfigurationMode)
TRANSITION("evaluate-discrete-states", EvaluateDiscreteStates)
TRANSITION("terminate", Terminate)
TRANSITION("reset", Reset)

EXPORT("update-discrete-states") void *update_discrete_states(struct AdapterInstance *self) {
  static struct {
    uint8_t failed;
    union {
      struct Discrete discrete;
      uint8_t status;
    };
  } result;
  struct Discrete *reported = &result.discrete;
  memset(&result, 0, sizeof result);
  fmi3Status status = fmi3UpdateDiscreteStates(self->instance, &reported->new_states_needed, &reported->terminates,
                                               &reported->nominals_changed, &reported->states_changed,
                                               &reported->has_next_event, &reported->next_event);
  result.failed = has_failed(status);
  if (result.failed) result.status = (uint8_t)status;
  return &result;
}

EXPORT("do-step") void *do_step(struct AdapterInstance *self, double time, double size, bool no_set_before) {
  static struct {
    uint8_t failed;
    union {
      struct Step step;
      uint8_t status;
    };
  } result;
  struct Step *reported = &result.step;
  memset(&result, 0, sizeof result);
  fmi3Status status = fmi3DoStep(self->instance, time, size, no_set_before, &reported->event_handling_needed,
                                 &reported->terminates, &reported->early_return, &reported->last_successful_time);
  result.failed = has_failed(status);
  if (result.failed) result.status = (uint8_t)status;
  return &result;
}

EXPORT("completed-integrator-step") void *completed_integrator_step(struct AdapterInstance *self, bool no_set_before) {
  static struct {
    uint8_t failed;
    union {
      struct CompletedStep step;
      uint8_t status;
    };
  } result;
  struct CompletedStep *reported = &result.step;
  memset(&result, 0, sizeof result);
  fmi3Status status =
      fmi3CompletedIntegratorStep(self->instance, no_set_before, &reported->enter_event_mode, &reported->terminates);
  result.failed = has_failed(status);
  if (result.failed) result.status = (uint8_t)status;
  return &result;
}

/* --- Values --- */

#define VALUES(suffix, Type)                                                                                           \
  EXPORT("get-" suffix)                                                                                                \
  struct ListResult *get_##Type(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n) {                      \
    fmi3##Type *values = allocate(n, sizeof *values);                                                                  \
    fmi3Status status = fmi3Get##Type(self->instance, vr, n, values, n);                                               \
    discard(vr, n);                                                                                                    \
    return list_result(status, values, n);                                                                             \
  }                                                                                                                    \
  EXPORT("set-" suffix)                                                                                                \
  fmi3Status set_##Type(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n, fmi3##Type *values,            \
                        size_t count) {                                                                                \
    fmi3Status status = fmi3Set##Type(self->instance, vr, n, values, count);                                           \
    discard(vr, n);                                                                                                    \
    discard(values, count);                                                                                            \
    return status;                                                                                                     \
  }
VALUES("float32", Float32)
VALUES("float64", Float64)
VALUES("int8", Int8)
VALUES("int16", Int16)
VALUES("int32", Int32)
VALUES("int64", Int64)
VALUES("uint8", UInt8)
VALUES("uint16", UInt16)
VALUES("uint32", UInt32)
VALUES("uint64", UInt64)
VALUES("boolean", Boolean)

/* Functions of types that no variable has: report an error for any reference, and return nothing for none. */
#define NO_VALUES(suffix, name, call)                                                                                  \
  EXPORT(suffix) struct ListResult *name(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n) {             \
    fmi3Status status = call;                                                                                          \
    discard(vr, n);                                                                                                    \
    return list_result(n == 0 ? fmi3OK : has_failed(status) ? status : fmi3Error, NULL, 0);                            \
  }
NO_VALUES("get-string", get_strings, fmi3GetString(self->instance, vr, n, NULL, n))
NO_VALUES("get-binary", get_binaries, fmi3GetBinary(self->instance, vr, n, NULL, NULL, n))
NO_VALUES("get-clock", get_clocks, fmi3GetClock(self->instance, vr, n, NULL))
NO_VALUES("get-interval-decimal", get_interval_decimal, fmi3GetIntervalDecimal(self->instance, vr, n, NULL, NULL))
NO_VALUES("get-interval-fraction", get_interval_fraction,
          fmi3GetIntervalFraction(self->instance, vr, n, NULL, NULL, NULL))
NO_VALUES("get-shift-decimal", get_shift_decimal, fmi3GetShiftDecimal(self->instance, vr, n, NULL))
NO_VALUES("get-shift-fraction", get_shift_fraction, fmi3GetShiftFraction(self->instance, vr, n, NULL, NULL))

#define NO_SETTING(suffix, name, call)                                                                                 \
  EXPORT(suffix)                                                                                                       \
  fmi3Status name(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n, void *values, size_t count) {        \
    fmi3Status status = call;                                                                                          \
    discard(vr, n);                                                                                                    \
    discard(values, count);                                                                                            \
    return n == 0 && count == 0 ? fmi3OK : has_failed(status) ? status : fmi3Error;                                    \
  }
NO_SETTING("set-clock", set_clocks, fmi3SetClock(self->instance, vr, n, values))
NO_SETTING("set-interval-decimal", set_interval_decimal, fmi3SetIntervalDecimal(self->instance, vr, n, values))
NO_SETTING("set-interval-fraction", set_interval_fraction, fmi3SetIntervalFraction(self->instance, vr, n, NULL, NULL))
NO_SETTING("set-shift-decimal", set_shift_decimal, fmi3SetShiftDecimal(self->instance, vr, n, values))
NO_SETTING("set-shift-fraction", set_shift_fraction, fmi3SetShiftFraction(self->instance, vr, n, NULL, NULL))

/* Frees lists of values that are texts or bytes. */
static void discard_texts(struct Text *texts, size_t count) {
  for (size_t i = 0; i < count; i++) discard(texts[i].characters, texts[i].count);
}

EXPORT("set-string")
fmi3Status set_strings(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n, struct Text *values,
                       size_t count) {
  fmi3Status status = fmi3SetString(self->instance, vr, n, NULL, count);
  discard(vr, n);
  discard_texts(values, count);
  discard(values, count);
  return n == 0 && count == 0 ? fmi3OK : has_failed(status) ? status : fmi3Error;
}

EXPORT("set-binary")
fmi3Status set_binaries(struct AdapterInstance *self, fmi3ValueReference *vr, size_t n, struct Text *values,
                        size_t count) {
  fmi3Status status = fmi3SetBinary(self->instance, vr, n, NULL, NULL, count);
  discard(vr, n);
  discard_texts(values, count);
  discard(values, count);
  return n == 0 && count == 0 ? fmi3OK : has_failed(status) ? status : fmi3Error;
}

EXPORT("get-number-of-variable-dependencies")
struct CountResult *get_number_of_variable_dependencies(struct AdapterInstance *self, fmi3ValueReference vr) {
  size_t count = 0;
  return count_result(fmi3GetNumberOfVariableDependencies(self->instance, vr, &count), count);
}

/* modelDescription.xml has the dependencies; this function returns none. */
EXPORT("get-variable-dependencies")
struct ListResult *get_variable_dependencies(struct AdapterInstance *self, fmi3ValueReference vr) {
  return list_result(fmi3GetVariableDependencies(self->instance, vr, NULL, NULL, NULL, NULL, 0), NULL, 0);
}

/* --- Saved states, serialized --- */

EXPORT("get-fmu-state") struct ListResult *get_fmu_state(struct AdapterInstance *self) {
  fmi3FMUState state = NULL;
  size_t size = 0;
  void *bytes = NULL;
  fmi3Status status = fmi3GetFMUState(self->instance, &state);
  if (!has_failed(status)) status = fmi3SerializedFMUStateSize(self->instance, state, &size);
  if (!has_failed(status)) {
    bytes = allocate(size, 1);
    status = fmi3SerializeFMUState(self->instance, state, bytes, size);
  }
  fmi3FreeFMUState(self->instance, &state);
  return list_result(status, bytes, bytes != NULL ? size : 0);
}

EXPORT("set-fmu-state") fmi3Status set_fmu_state(struct AdapterInstance *self, const fmi3Byte *bytes, size_t count) {
  fmi3FMUState state = NULL;
  fmi3Status status = fmi3DeserializeFMUState(self->instance, bytes, count, &state);
  discard(bytes, count);
  if (!has_failed(status)) status = fmi3SetFMUState(self->instance, state);
  fmi3FreeFMUState(self->instance, &state);
  return status;
}

/* --- Derivatives --- */

#define DERIVATIVE(name, function, result_count)                                                                       \
  EXPORT(name)                                                                                                         \
  struct ListResult *derivative_##function(struct AdapterInstance *self, fmi3ValueReference *unknowns, size_t rows,    \
                                           fmi3ValueReference *knowns, size_t columns, double *seed, size_t seeds) {   \
    double *values = allocate(result_count, sizeof *values);                                                           \
    fmi3Status status =                                                                                                \
        fmi3##function(self->instance, unknowns, rows, knowns, columns, seed, seeds, values, result_count);            \
    discard(unknowns, rows);                                                                                           \
    discard(knowns, columns);                                                                                          \
    discard(seed, seeds);                                                                                              \
    return list_result(status, values, result_count);                                                                  \
  }
DERIVATIVE("get-directional-derivative", GetDirectionalDerivative, rows)
DERIVATIVE("get-adjoint-derivative", GetAdjointDerivative, columns)

EXPORT("get-output-derivatives")
struct ListResult *get_output_derivatives(struct AdapterInstance *self, struct Order *requests, size_t n) {
  fmi3ValueReference *vr = allocate(n, sizeof *vr);
  fmi3Int32 *orders = allocate(n, sizeof *orders);
  double *values = allocate(n, sizeof *values);
  for (size_t i = 0; i < n; i++) {
    vr[i] = requests[i].reference;
    orders[i] = (fmi3Int32)requests[i].order;
  }
  fmi3Status status = fmi3GetOutputDerivatives(self->instance, vr, n, orders, values, n);
  discard(vr, n);
  discard(orders, n);
  discard(requests, n);
  return list_result(status, values, n);
}

/* The draft has this function of FMI 2.0; FMI 3.0 does not. */
EXPORT("set-input-derivatives")
fmi3Status set_input_derivatives(struct AdapterInstance *self, struct Order *requests, size_t n, double *values,
                                 size_t count) {
  discard(requests, n);
  discard(values, count);
  if (n == 0 && count == 0) return fmi3OK;
  hand_on(self->name, fmi3Error, "logStatusError",
          "set-input-derivatives: FMI 3.0 has no derivatives of inputs; set inputs at each step");
  return fmi3Error;
}

/* --- Model exchange --- */

EXPORT("set-time") fmi3Status set_time(struct AdapterInstance *self, double time) {
  return fmi3SetTime(self->instance, time);
}

EXPORT("set-continuous-states")
fmi3Status set_continuous_states(struct AdapterInstance *self, double *states, size_t n) {
  fmi3Status status = fmi3SetContinuousStates(self->instance, states, n);
  discard(states, n);
  return status;
}

#define VECTOR(name, function, count)                                                                                  \
  EXPORT(name) struct ListResult *vector_##function(struct AdapterInstance *self) {                                    \
    double *values = allocate(self->count, sizeof *values);                                                            \
    return list_result(fmi3##function(self->instance, values, self->count), values, self->count);                      \
  }
VECTOR("get-continuous-states", GetContinuousStates, state_count)
VECTOR("get-continuous-state-derivatives", GetContinuousStateDerivatives, state_count)
VECTOR("get-nominals-of-continuous-states", GetNominalsOfContinuousStates, state_count)
VECTOR("get-event-indicators", GetEventIndicators, indicator_count)

EXPORT("get-number-of-continuous-states")
struct CountResult *get_number_of_continuous_states(struct AdapterInstance *self) {
  size_t count = 0;
  return count_result(fmi3GetNumberOfContinuousStates(self->instance, &count), count);
}

EXPORT("get-number-of-event-indicators")
struct CountResult *get_number_of_event_indicators(struct AdapterInstance *self) {
  size_t count = 0;
  return count_result(fmi3GetNumberOfEventIndicators(self->instance, &count), count);
}
