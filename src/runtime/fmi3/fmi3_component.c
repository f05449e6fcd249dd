/* Creates and frees instances, and sends their messages to the caller's logger (section 2.3.1). */
#include "fmi3/fmi3_component.h"

#include <string.h>

#include "fmi/log_categories.h"
#include "fmi3/fmi3_memory.h"
#include "fmi3/fmi3_references.h"

/* Escapes '#', which introduces a variable in a message. */
static void send(void *receiver, enum Status status, const char *message) {
  const struct FmiComponent *component = receiver;
  char escaped[2 * MESSAGE_LENGTH];
  log_escape(message, "#", escaped);
  component->logger(component->environment, status_of(status), log_category_of(status), escaped);
}

struct Log log_of(struct FmiComponent *component) {
  return (struct Log){
      .write = send, .receiver = component, .wanted = log_wanted(component->logger != NULL, component->categories)};
}

/* Without logging no message is sent, not even of a failed instantiation (section 2.3.1). */
static unsigned categories_of(bool logging) {
  return logging ? ALL_CATEGORIES : 0;
}

/* Checks the arguments that all kinds of instances have. */
static bool can_instantiate(const struct Log *log, const char *name, const char *token, const char *function) {
  if (name == NULL || name[strspn(name, " \t\r\n")] == '\0')
    log_write(log, STATUS_ERROR, "%s: the instance has no name; expected one", function);
  else if (token == NULL || strcmp(token, lagrangian.guid) != 0)
    log_write(log, STATUS_ERROR, "%s: the instantiation token is '%s'; expected '%s', that of this binary", function,
              token != NULL ? token : "NULL", lagrangian.guid);
  else return true;
  return false;
}

/* True if the variables exist and have values within a communication step. */
static bool can_be_intermediate(const struct Log *log, const fmi3ValueReference *references, size_t count,
                                const char *function) {
  if (references == NULL && count > 0) {
    log_write(log, STATUS_ERROR, "%s: requiredIntermediateVariables is NULL; expected %zu elements", function, count);
    return false;
  }
  for (size_t i = 0; i < count; i++) {
    unsigned slot = slot_of_reference(references[i]);
    if (slot < lagrangian.variable_count && is_intermediate(&lagrangian.variables[slot])) continue;
    log_write(log, STATUS_ERROR,
              "%s: the value reference %u among requiredIntermediateVariables does not belong to a variable with "
              "intermediateUpdate=\"true\"",
              function, references[i]);
    return false;
  }
  return true;
}

/* Frees a component whose instance holds no memory. */
static void component_free(struct FmiComponent *component) {
  fmi3_memory.free(component->before);
  fmi3_memory.free(component->intermediate.kept);
  fmi3_memory.free(component->intermediate.inputs);
  for (int i = 0; i < WORKSPACE_COUNT; i++) fmi3_memory.free(component->workspaces[i].block);
  fmi3_memory.free(component);
}

/* Creates a component. NULL without memory; then nothing is allocated. */
static struct FmiComponent *component_create(const struct FmiComponent *description, enum InterfaceType kind) {
  struct FmiComponent *component = fmi3_memory.allocate(1, sizeof *component);
  if (component == NULL) return NULL;
  *component = *description;
  struct Intermediate *intermediate = &component->intermediate;
  component->before = fmi3_memory.allocate(1, fmu_state_size());
  intermediate->kept = fmi3_memory.allocate(1, fmu_state_size());
  intermediate->inputs = fmi3_memory.allocate(1 + INPUT_NODES * lagrangian.input_count, sizeof(double));
  struct Log log = log_of(component);
  if (component->before != NULL && intermediate->kept != NULL && intermediate->inputs != NULL &&
      instance_create(&component->instance, kind, &fmi3_memory, &log))
    return component;
  component_free(component);
  return NULL;
}

static struct FmiComponent *instantiate(const struct FmiComponent *description, enum InterfaceType kind,
                                        const struct Log *log, const char *function) {
  struct FmiComponent *component = component_create(description, kind);
  if (component == NULL) {
    log_write(log, STATUS_ERROR, "%s: out of memory", function);
    return NULL;
  }
  log_message(&component->instance, STATUS_DONE, "%s instantiated", lagrangian.name);
  return component;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage) {
  (void)resourcePath;
  (void)visible;
  struct FmiComponent description = {
      .logger = logMessage, .environment = environment, .categories = categories_of(loggingOn)};
  struct Log log = log_of(&description);
  if (!can_instantiate(&log, instanceName, instantiationToken, __func__)) return NULL;
  return instantiate(&description, KIND_MODEL_EXCHANGE, &log, __func__);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate) {
  (void)resourcePath;
  (void)visible;
  struct FmiComponent description = {.logger = logMessage,
                                     .environment = environment,
                                     .categories = categories_of(loggingOn),
                                     .intermediate_update = intermediateUpdate,
                                     .early_return_allowed = earlyReturnAllowed};
  struct Log log = log_of(&description);
  if (!can_instantiate(&log, instanceName, instantiationToken, __func__) ||
      !can_be_intermediate(&log, requiredIntermediateVariables, nRequiredIntermediateVariables, __func__))
    return NULL;
  if (eventModeUsed && lagrangian.event_laws == NULL) {
    log_write(&log, STATUS_ERROR,
              "%s: eventModeUsed is true; expected false, since the system has no events (no hasEventMode)", __func__);
    return NULL;
  }
  struct FmiComponent *component = instantiate(&description, KIND_CO_SIMULATION, &log, __func__);
  if (component == NULL) return NULL;
  for (size_t i = 0; i < nRequiredIntermediateVariables; i++)
    component->sets_inputs |=
        lagrangian.variables[slot_of_reference(requiredIntermediateVariables[i])].kind == VARIABLE_INPUT;
  component->instance.uses_event_mode = eventModeUsed;
  component->instance.stops_at_events = eventModeUsed && earlyReturnAllowed;
  return component;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logMessage,
                                               fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption) {
  (void)instanceName;
  (void)instantiationToken;
  (void)resourcePath;
  (void)visible;
  (void)loggingOn;
  (void)clockUpdate;
  (void)lockPreemption;
  (void)unlockPreemption;
  struct FmiComponent description = {
      .logger = logMessage, .environment = environment, .categories = categories_of(loggingOn)};
  struct Log log = log_of(&description);
  log_write(&log, STATUS_ERROR, "%s: the FMU supports only model exchange and co-simulation", __func__);
  return NULL;
}

void fmi3FreeInstance(fmi3Instance c) {
  struct FmiComponent *component = c;
  if (component == NULL) return;
  instance_destroy(&component->instance);
  component_free(component);
}
