#include "instance.h"

#include <stdlib.h>
#include <string.h>

#include "evaluate.h"
#include "log.h"
#include "solver.h"

static size_t value_count(void) {
  return lagrangian.state_count + (1 + INPUT_ORDER) * lagrangian.input_count + lagrangian.parameter_count;
}

size_t situation_size(void) {
  bool saves = lagrangian.solver != NULL && lagrangian.solver->saved_size != NULL;
  return sizeof(struct Situation) + value_count() * sizeof(double) + (saves ? lagrangian.solver->saved_size() : 0);
}

void situation_reset(struct Instance *instance) {
  memset(instance->situation, 0, situation_size());
  instance->situation->mode = MODE_INSTANTIATED;
  instance->situation->type = (int32_t)instance->type;
  instance->situation->tolerance = lagrangian.tolerance;
  for (size_t i = 0; i < lagrangian.variable_count; i++) {
    const struct ScalarVariable *variable = &lagrangian.variables[i];
    if (variable->kind == VARIABLE_STATE) instance->state[variable->index] = variable->start;
    if (variable->kind == VARIABLE_INPUT) instance->input[variable->index] = variable->start;
    if (variable->kind == VARIABLE_PARAMETER) instance->parameter[variable->index] = variable->start;
  }
  instance->situation->changed = 1;
  instance->prepared_is_stale = instance->solver_is_stale = true;
}

/* Whether canNotUseMemoryManagementFunctions is true: the caller's functions are then ignored, and may be NULL. */
static bool allocates_by_itself(void) {
  return lagrangian.solver != NULL && lagrangian.solver->allocates_by_itself;
}

/* Checks the arguments of fmi2Instantiate that do not need an instance. */
static bool can_instantiate(fmi2String name, fmi2Type type, fmi2String guid, const fmi2CallbackFunctions *functions) {
  if (functions == NULL) return false;
  if (!allocates_by_itself() && (functions->allocateMemory == NULL || functions->freeMemory == NULL)) {
    log_instantiation(functions, name, "fmi2Instantiate: allocateMemory or freeMemory is NULL; expected both");
    return false;
  }
  if (name == NULL || *name == '\0') {
    log_instantiation(functions, name, "fmi2Instantiate: the instance has no name; expected one");
    return false;
  }
  if (type != fmi2ModelExchange && type != fmi2CoSimulation) {
    log_instantiation(functions, name, "fmi2Instantiate: the type %d is unknown", (int)type);
    return false;
  }
  if (guid != NULL && strcmp(guid, lagrangian.guid) == 0) return true;
  log_instantiation(functions, name, "fmi2Instantiate: the GUID is '%s'; expected '%s', that of this binary",
                    guid != NULL ? guid : "NULL", lagrangian.guid);
  return false;
}

/* Divides one block of memory among the arrays. */
static void lay_out(struct Instance *instance, double *evaluation) {
  instance->state = instance->situation->values;
  instance->input = instance->state + lagrangian.state_count;
  instance->parameter = instance->input + lagrangian.input_count;
  instance->input_derivatives = instance->parameter + lagrangian.parameter_count;
  instance->saved = instance->input_derivatives + INPUT_ORDER * lagrangian.input_count;
  instance->prepared = evaluation;
  instance->point_work = evaluation + lagrangian.prepared_count;
  instance->work = instance->point_work + lagrangian.work_count;
}

static size_t evaluation_count(void) {
  return lagrangian.prepared_count + lagrangian.work_count + 3 * lagrangian.state_count + 2 * lagrangian.input_count +
         lagrangian.parameter_count + 1;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn) {
  (void)fmuResourceLocation;
  (void)visible;
  if (!can_instantiate(instanceName, fmuType, fmuGUID, functions)) return NULL;
  size_t name_size = strlen(instanceName) + 1;
  fmi2CallbackAllocateMemory acquire = allocates_by_itself() ? calloc : functions->allocateMemory;
  fmi2CallbackFreeMemory release = allocates_by_itself() ? free : functions->freeMemory;
  struct Instance *instance = acquire(1, sizeof *instance);
  struct Situation *situation = acquire(1, situation_size());
  double *evaluation = acquire(evaluation_count(), sizeof *evaluation);
  char *name = acquire(name_size, 1);
  if (instance == NULL || situation == NULL || evaluation == NULL || name == NULL) {
    log_instantiation(functions, instanceName, "fmi2Instantiate: allocateMemory returned no memory");
    void *const blocks[] = {instance, situation, evaluation, name};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
      if (blocks[i] != NULL) release(blocks[i]);
    return NULL;
  }
  memcpy(name, instanceName, name_size);
  *instance = (struct Instance){.logger = functions->logger,
                                .allocate = acquire,
                                .free = release,
                                .environment = functions->componentEnvironment,
                                .name = name,
                                .type = fmuType,
                                .log_categories = loggingOn ? ALL_LOG_CATEGORIES : 0,
                                .situation = situation};
  lay_out(instance, evaluation);
  situation_reset(instance);
  log_message(instance, fmi2OK, "%s instantiated", lagrangian.name);
  return instance;
}

void fmi2FreeInstance(fmi2Component c) {
  struct Instance *instance = c;
  if (instance == NULL) return;
  if (instance->solver_memory != NULL) lagrangian.solver->destroy(instance);
  fmi2CallbackFreeMemory release = instance->free;
  release(instance->name);
  release(instance->prepared);
  release(instance->situation);
  release(instance);
}
