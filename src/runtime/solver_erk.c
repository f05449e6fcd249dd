/*
 * Dormand and Prince's explicit Runge-Kutta method of order 5(4), by ERKStep of SUNDIALS. Every communication step
 * starts the solver anew from the state and the step size that the situation holds, so that it depends on nothing
 * else.
 */
#include <stdlib.h>
#include <string.h>

#include <arkode/arkode_erkstep.h>

#include "log.h"
#include "solver.h"
#include "sundials_support.h"

/* Local errors of the order of the tolerance add up to more than it; see tests/test_motion.py. */
static const double safety = 0.1;

struct Erk {
  struct SundialsVectors vectors;
  void *arkode;
};

static int right_side(realtype time, N_Vector state, N_Vector derivative, void *instance) {
  bool exists = solver_derivatives(instance, time, N_VGetArrayPointer(state), N_VGetArrayPointer(derivative));
  return exists ? 0 : 1; /* recoverable: a shorter step may avoid the point */
}

static void destroy(struct Instance *instance) {
  struct Erk *erk = instance->solver_memory;
  if (erk->arkode != NULL) ERKStepFree(&erk->arkode);
  sundials_vectors_destroy(&erk->vectors);
  instance->free(erk);
  instance->solver_memory = NULL;
}

static bool configure(struct Instance *instance, struct Erk *erk) {
  erk->arkode = ERKStepCreate(right_side, instance->situation->time, erk->vectors.state, erk->vectors.context);
  return erk->arkode != NULL &&
         sundials_succeeded(instance, ERKStepSetErrHandlerFn(erk->arkode, sundials_ignore_error, NULL),
                            "ERKStepSetErrHandlerFn") &&
         sundials_succeeded(instance, ERKStepSetUserData(erk->arkode, instance), "ERKStepSetUserData") &&
         sundials_succeeded(instance, ERKStepSetTableNum(erk->arkode, ARKODE_DORMAND_PRINCE_7_4_5),
                            "ERKStepSetTableNum") &&
         sundials_succeeded(instance, ERKStepSetMaxNumSteps(erk->arkode, STEP_LIMIT), "ERKStepSetMaxNumSteps") &&
         sundials_succeeded(instance, ERKStepSetMaxStep(erk->arkode, lagrangian.max_step), "ERKStepSetMaxStep") &&
         sundials_succeeded(instance, ERKStepSetMaxHnilWarns(erk->arkode, -1), "ERKStepSetMaxHnilWarns") &&
         sundials_succeeded(instance, ERKStepSetInterpolantDegree(erk->arkode, 1), "ERKStepSetInterpolantDegree");
}

static bool create(struct Instance *instance) {
  struct Erk *erk = instance->allocate(1, sizeof *erk);
  if (erk == NULL) {
    log_message(instance, fmi2Error, "allocateMemory returned no memory for the solver");
    return false;
  }
  instance->solver_memory = erk;
  if (sundials_vectors_create(instance, &erk->vectors)) {
    memcpy(N_VGetArrayPointer(erk->vectors.state), instance->state, lagrangian.state_count * sizeof(double));
    if (configure(instance, erk)) return true;
  }
  destroy(instance);
  return false;
}

static bool restart(struct Instance *instance, struct Erk *erk, double end) {
  struct Situation *situation = instance->situation;
  memcpy(N_VGetArrayPointer(erk->vectors.state), instance->state, lagrangian.state_count * sizeof(double));
  double relative = sundials_tolerances(instance, &erk->vectors, safety);
  double first = situation->suggested_step < end - situation->time ? situation->suggested_step : end - situation->time;
  return sundials_succeeded(instance, ERKStepReInit(erk->arkode, right_side, situation->time, erk->vectors.state),
                            "ERKStepReInit") &&
         sundials_succeeded(instance, ERKStepSVtolerances(erk->arkode, relative, erk->vectors.tolerance),
                            "ERKStepSVtolerances") &&
         sundials_succeeded(instance, ERKStepSetInitStep(erk->arkode, first), "ERKStepSetInitStep") &&
         sundials_succeeded(instance, ERKStepSetStopTime(erk->arkode, end), "ERKStepSetStopTime");
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Erk *erk = instance->solver_memory;
  struct Situation *situation = instance->situation;
  double end = situation->time + length;
  if (sundials_tiny_step(instance, end)) return STEP_DONE;
  if (!restart(instance, erk, end)) return STEP_FAILED;
  realtype time = situation->time;
  int flag = ERKStepEvolve(erk->arkode, end, erk->vectors.state, &time, ARK_NORMAL);
  long steps = 0;
  double next = 0.0;
  if (!sundials_succeeded(instance, ERKStepGetNumSteps(erk->arkode, &steps), "ERKStepGetNumSteps") ||
      !sundials_succeeded(instance, ERKStepGetCurrentStep(erk->arkode, &next), "ERKStepGetCurrentStep"))
    return STEP_FAILED;
  situation->statistics[STATISTIC_STEPS] += (int32_t)steps;
  memcpy(instance->state, N_VGetArrayPointer(erk->vectors.state), lagrangian.state_count * sizeof(double));
  if (flag >= 0) {
    situation->suggested_step = next;
    return STEP_DONE;
  }
  char *name = ERKStepGetReturnFlagName(flag);
  sundials_log_stop(instance, "ERKStep", flag, name, time, end);
  free(name);
  *reached = time;
  return STEP_PARTIAL;
}

const struct Solver solver_erk = {.allocates_by_itself = true, .create = create, .destroy = destroy, .step = step};
