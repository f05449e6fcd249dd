/* Creation and end of an instance, and its messages to the caller's logger (sections 2.1.4 and 2.1.5). */
#include "fmi2_component.h"

#include <string.h>

#include "check.h"
#include "fmi2_life_cycle.h"

enum Category { CATEGORY_EVENTS, CATEGORY_WARNING, CATEGORY_DISCARD, CATEGORY_ERROR, CATEGORY_FATAL, CATEGORY_ALL };

static const char *const categories[] = {
    [CATEGORY_EVENTS] = "logEvents",         [CATEGORY_WARNING] = "logStatusWarning",
    [CATEGORY_DISCARD] = "logStatusDiscard", [CATEGORY_ERROR] = "logStatusError",
    [CATEGORY_FATAL] = "logStatusFatal",     [CATEGORY_ALL] = "logAll",
};
/* What goes wrong is sent without debug logging too, unless fmi2SetDebugLogging names categories. */
enum {
  CATEGORY_COUNT = sizeof categories / sizeof *categories,
  ALL_CATEGORIES = (1u << CATEGORY_COUNT) - 1u,
  CATEGORIES_WITHOUT_DEBUGGING =
      1u << CATEGORY_WARNING | 1u << CATEGORY_DISCARD | 1u << CATEGORY_ERROR | 1u << CATEGORY_FATAL
};

static enum Category category_of(enum Status status) {
  static const enum Category of[] = {[STATUS_DONE] = CATEGORY_EVENTS,
                                     [STATUS_WARNING] = CATEGORY_WARNING,
                                     [STATUS_DISCARD] = CATEGORY_DISCARD,
                                     [STATUS_ERROR] = CATEGORY_ERROR};
  return of[status];
}

/* Which messages the core has to write. */
static unsigned wanted_statuses(const struct Component *component) {
  unsigned wanted = 0;
  for (int status = STATUS_DONE; status <= STATUS_ERROR; status++)
    if ((component->categories & (1u << category_of((enum Status)status) | 1u << CATEGORY_ALL)) != 0)
      wanted |= 1u << status;
  return component->logger != NULL ? wanted : 0;
}

/* The message is itself a printf format, and '#' introduces a variable in it (section 2.1.5). */
static void send(void *receiver, enum Status status, const char *message) {
  const struct Component *component = receiver;
  char escaped[2 * MESSAGE_LENGTH];
  size_t length = 0;
  for (; *message != '\0'; message++) {
    if (*message == '%' || *message == '#') escaped[length++] = *message;
    escaped[length++] = *message;
  }
  escaped[length] = '\0';
  component->logger(component->environment, component->name, fmi2_status(status), categories[category_of(status)],
                    escaped);
}

/* Checks the arguments of fmi2Instantiate. */
static bool can_instantiate(const struct Log *log, const char *name, fmi2Type type, const char *guid,
                            const struct Allocator *memory) {
  if (memory->allocate == NULL || memory->free == NULL)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: allocateMemory or freeMemory is NULL; expected both");
  else if (name == NULL || *name == '\0')
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the instance has no name; expected one");
  else if (type != fmi2ModelExchange && type != fmi2CoSimulation)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the type %d is unknown", (int)type);
  else if (guid == NULL || strcmp(guid, lagrangian.guid) != 0)
    log_write(log, STATUS_ERROR, "fmi2Instantiate: the GUID is '%s'; expected '%s', that of this binary",
              guid != NULL ? guid : "NULL", lagrangian.guid);
  else return true;
  return false;
}

/* A component with its core, name and messages; NULL, and nothing is allocated, where there is no memory. */
static struct Component *component_create(const struct Component *description, enum Kind kind,
                                          const struct Allocator *memory) {
  size_t name_size = strlen(description->name) + 1;
  struct Component *component = memory->allocate(1, sizeof *component);
  char *name = memory->allocate(name_size, 1);
  if (component != NULL && name != NULL) {
    *component = *description;
    component->name = memcpy(name, description->name, name_size);
    struct Log log = {.write = send, .receiver = component, .wanted = wanted_statuses(component)};
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
  struct Component description = {.logger = functions->logger,
                                  .environment = functions->componentEnvironment,
                                  .name = instanceName != NULL ? instanceName : "",
                                  .categories = ALL_CATEGORIES};
  struct Log log = {.write = send, .receiver = &description, .wanted = wanted_statuses(&description)};
  struct Allocator memory = {functions->allocateMemory, functions->freeMemory};
  if (!can_instantiate(&log, instanceName, fmuType, fmuGUID, &memory)) return NULL;
  if (!loggingOn) description.categories = CATEGORIES_WITHOUT_DEBUGGING;
  enum Kind kind = fmuType == fmi2ModelExchange ? KIND_MODEL_EXCHANGE : KIND_CO_SIMULATION;
  struct Component *component = component_create(&description, kind, &memory);
  if (component == NULL) log_write(&log, STATUS_ERROR, "fmi2Instantiate: allocateMemory returned no memory");
  else log_message(&component->instance, STATUS_DONE, "%s instantiated", lagrangian.name);
  return component;
}

void fmi2FreeInstance(fmi2Component c) {
  struct Component *component = c;
  if (component == NULL) return;
  struct Allocator memory = component->instance.memory;
  instance_destroy(&component->instance);
  memory.free((void *)component->name);
  memory.free(component);
}

/* CATEGORY_COUNT where there is no category of this name. */
static int category_named(const char *name) {
  int category = 0;
  while (category < CATEGORY_COUNT && (name == NULL || strcmp(name, categories[category]) != 0)) category++;
  return category;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String names[]) {
  struct Component *component = c;
  struct Instance *instance = enter(c, FUNCTION_SET_DEBUG_LOGGING, __func__);
  if (instance == NULL || !check_array(instance, names, nCategories, __func__, "categories")) return fmi2Error;
  unsigned chosen = 0;
  for (size_t i = 0; i < nCategories; i++) {
    int category = category_named(names[i]);
    if (category == CATEGORY_COUNT)
      return fmi2_status(
          log_error(instance, "%s: there is no log category '%s'", __func__, names[i] != NULL ? names[i] : "NULL"));
    chosen |= 1u << category;
  }
  if (nCategories == 0) component->categories = loggingOn ? ALL_CATEGORIES : CATEGORIES_WITHOUT_DEBUGGING;
  else component->categories = loggingOn ? chosen : component->categories & ~chosen;
  instance->log.wanted = wanted_statuses(component);
  return fmi2OK;
}
