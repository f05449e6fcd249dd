/* Creates and frees instances, and sends their messages to the caller's logger (sections 2.1.4 and 2.1.5). */
#include "fmi2/fmi2_component.h"

#include <string.h>

#include "fmi/log_categories.h"

/* Escapes '%', since the message is a printf format, and '#', which introduces a variable (section 2.1.5). */
static void send(void *receiver, enum Status status, const char *message) {
  const struct FmiComponent *component = receiver;
  char escaped[2 * MESSAGE_LENGTH];
  log_escape(message, "%#", escaped);
  component->logger(component->environment, component->name, status_of(status), log_category_of(status), escaped);
}

struct Log log_of(struct FmiComponent *component) {
  return (struct Log){
      .write = send, .receiver = component, .wanted = log_wanted(component->logger != NULL, component->categories)};
}

/* Checks the arguments of fmi2Instantiate. */
static bool can_instantiate(const struct Log *log, const char *name, fmi2Type type, const char *guid,
                            const struct Allocator *memory) {
  if (memory->allocate == NULL || memory->free == NULL)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: allocateMemory or freeMemory is NULL; expected both");
  else if (name == NULL || *name == '\0')
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the instance has no name; expected one");
  else if (type != fmi2ModelExchange && type != fmi2CoSimulation)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the type is %d; expected fmi2ModelExchange or fmi2CoSimulation",
              (int)type);
  else if (guid == NULL || strcmp(guid, lagrangian.guid) != 0)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the GUID is '%s'; expected '%s', that of this binary",
              guid != NULL ? guid : "NULL", lagrangian.guid);
  else return true;
  return false;
}

/* Creates a component with its instance, name and messages. NULL without memory; then nothing is allocated. */
static struct FmiComponent *component_create(const struct FmiComponent *description, enum InterfaceType kind,
                                             const struct Allocator *memory) {
  size_t name_size = strlen(description->name) + 1;
  struct FmiComponent *component = memory->allocate(1, sizeof *component);
  char *name = memory->allocate(name_size, 1);
  if (component != NULL && name != NULL) {
    *component = *description;
    component->name = memcpy(name, description->name, name_size);
    struct Log log = log_of(component);
    if (instance_create(&component->instance, kind, memory, &log)) return component;
  }
  if (component != NULL) memory->free(component);
  if (name != NULL) memory->free(name);
  return NULL;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn) {
  (void)fmuResourceLocation;
  (void)visible;
  if (functions == NULL) return NULL;
  struct FmiComponent description = {.logger = functions->logger,
                                     .environment = functions->componentEnvironment,
                                     .name = instanceName != NULL ? instanceName : "",
                                     .categories = ALL_CATEGORIES};
  struct Log log = log_of(&description);
  struct Allocator memory = {functions->allocateMemory, functions->freeMemory};
  if (!can_instantiate(&log, instanceName, fmuType, fmuGUID, &memory)) return NULL;
  /* Warnings and errors are sent without debug logging too, unless fmi2SetDebugLogging names categories. */
  if (!loggingOn) description.categories = PROBLEM_CATEGORIES;
  enum InterfaceType kind = fmuType == fmi2ModelExchange ? KIND_MODEL_EXCHANGE : KIND_CO_SIMULATION;
  struct FmiComponent *component = component_create(&description, kind, &memory);
  if (component == NULL) log_write(&log, STATUS_ERROR, "fmi2Instantiate: allocateMemory returned no memory");
  else log_message(&component->instance, STATUS_DONE, "%s instantiated", lagrangian.name);
  return component;
}

void fmi2FreeInstance(fmi2Component c) {
  struct FmiComponent *component = c;
  if (component == NULL) return;
  struct Allocator memory = component->instance.memory;
  instance_destroy(&component->instance);
  memory.free((void *)component->name);
  memory.free(component);
}
