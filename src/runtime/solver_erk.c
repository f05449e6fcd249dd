/*
 * Dormand and Prince's explicit Runge-Kutta method of order 5(4), by ERKStep of SUNDIALS. Every communication step
 * starts the solver anew from the state and the step size that the situation holds, so that it depends on nothing
 * else.
 */
#include <float.h>
#include <math.h>
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
  N_Vector before;        /* the state before an internal step */
  N_Vector first, second; /* workspace for looking at a step */
  void *arkode;
};

static int right_side(realtype time, N_Vector state, N_Vector derivative, void *instance) {
  bool exists = solver_derivatives(instance, time, N_VGetArrayPointer(state), N_VGetArrayPointer(derivative));
  return exists ? 0 : 1; /* recoverable: a shorter step may avoid the point */
}

static void destroy(struct Instance *instance) {
  struct Erk *erk = instance->solver_memory;
  if (erk->arkode != NULL) ERKStepFree(&erk->arkode);
  if (erk->before != NULL) N_VDestroy(erk->before);
  if (erk->first != NULL) N_VDestroy(erk->first);
  if (erk->second != NULL) N_VDestroy(erk->second);
  sundials_vectors_destroy(instance, &erk->vectors);
  instance->free(erk);
  instance->solver_memory = NULL;
}

static bool configure(struct Instance *instance, struct Erk *erk) {
  sunindextype n = (sunindextype)lagrangian.state_count;
  erk->before = N_VNew_Serial(n, erk->vectors.context);
  erk->first = N_VNew_Serial(n, erk->vectors.context);
  erk->second = N_VNew_Serial(n, erk->vectors.context);
  erk->arkode = ERKStepCreate(right_side, instance->situation->time, erk->vectors.state, erk->vectors.context);
  return erk->before != NULL && erk->first != NULL && erk->second != NULL && erk->arkode != NULL &&
         sundials_succeeded(instance, ERKStepSetErrHandlerFn(erk->arkode, sundials_ignore_error, NULL),
                            "ERKStepSetErrHandlerFn") &&
         sundials_succeeded(instance, ERKStepSetUserData(erk->arkode, instance), "ERKStepSetUserData") &&
         sundials_succeeded(instance, ERKStepSetTableNum(erk->arkode, ARKODE_DORMAND_PRINCE_7_4_5),
                            "ERKStepSetTableNum") &&
         sundials_succeeded(instance, ERKStepSetMaxNumSteps(erk->arkode, STEP_LIMIT), "ERKStepSetMaxNumSteps") &&
         sundials_succeeded(instance, ERKStepSetMaxStep(erk->arkode, lagrangian.max_step), "ERKStepSetMaxStep") &&
         sundials_succeeded(instance, ERKStepSetMaxHnilWarns(erk->arkode, -1), "ERKStepSetMaxHnilWarns") &&
         sundials_succeeded(instance, ERKStepSetInterpolantDegree(erk->arkode, 3), "ERKStepSetInterpolantDegree");
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

/* Starts at time and vectors.state with a step of this length, 0 for one that ERKStep chooses. */
static bool start(struct Instance *instance, struct Erk *erk, double time, double first, double end) {
  return sundials_succeeded(instance, ERKStepReInit(erk->arkode, right_side, time, erk->vectors.state),
                            "ERKStepReInit") &&
         sundials_succeeded(instance, ERKStepSVtolerances(erk->arkode, erk->vectors.relative, erk->vectors.tolerance),
                            "ERKStepSVtolerances") &&
         sundials_succeeded(instance, ERKStepSetInitStep(erk->arkode, fmin(first, end - time)), "ERKStepSetInitStep") &&
         sundials_succeeded(instance, ERKStepSetStopTime(erk->arkode, end), "ERKStepSetStopTime");
}

/*
 * Whether two values of the derivative of state i differ by as much as they are large, and by far more than the
 * tolerance explains over a step.
 */
static bool differ(const struct SundialsVectors *vectors, size_t i, double step, double one, double other) {
  double weight =
      vectors->relative * fabs(N_VGetArrayPointer(vectors->state)[i]) + N_VGetArrayPointer(vectors->tolerance)[i];
  double difference = fabs(one - other);
  return difference > 0.5 * fmax(fabs(one), fabs(other)) && step * difference > 20.0 * weight;
}

/* Whether the derivatives at both ends of the last step are alike, as those of most steps are. */
static bool is_steady(const struct Erk *erk, double before, double time) {
  if (ERKStepGetDky(erk->arkode, before, 1, erk->first) < 0 || ERKStepGetDky(erk->arkode, time, 1, erk->second) < 0)
    return false;
  const double *first = N_VGetArrayPointer(erk->first), *last = N_VGetArrayPointer(erk->second);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    if (differ(&erk->vectors, i, time - before, first[i], last[i])) return false;
  return true;
}

/*
 * Whether the cubic polynomial through the last step looks like a solution inside of it. The method looks at the right
 * side in few places, and a step across a singularity may please its error estimate.
 */
static bool obeys_equations(struct Instance *instance, const struct Erk *erk, double before, double time) {
  enum { SAMPLES = 8 };
  double *derivative = instance->work + lagrangian.input_count;
  if (is_steady(erk, before, time)) return true;
  for (int k = 0; k < SAMPLES; k++) {
    double place = before + (k + 0.5) / SAMPLES * (time - before);
    if (ERKStepGetDky(erk->arkode, place, 0, erk->first) < 0 || ERKStepGetDky(erk->arkode, place, 1, erk->second) < 0 ||
        !solver_derivatives(instance, place, N_VGetArrayPointer(erk->first), derivative))
      return false;
    for (size_t i = 0; i < lagrangian.state_count; i++)
      if (differ(&erk->vectors, i, time - before, derivative[i], N_VGetArrayPointer(erk->second)[i])) return false;
  }
  return true;
}

/*
 * Goes to the end step by step. Where a step cannot be, as a trial stage has no right side or the polynomial does not
 * obey the equations, a tenth of it is tried. NULL, or the reason why the state stays at *time before the end.
 */
static const char *reach(struct Instance *instance, struct Erk *erk, double *time, double end) {
  double trial = end - *time;
  int resting = 0;
  for (long steps = 0; *time < end; steps++) {
    if (steps == STEP_LIMIT) return "too many steps";
    double before = *time;
    N_VScale(1.0, erk->vectors.state, erk->before);
    const double *state = N_VGetArrayPointer(erk->vectors.state);
    double longest = sundials_longest_step(instance, &erk->vectors, before, state, end - before);
    if (longest < end - before && sundials_rests(before, longest)) return resting_steps;
    ERKStepSetStopTime(erk->arkode, fmin(before + longest, end));
    int flag = ERKStepEvolve(erk->arkode, end, erk->vectors.state, time, ARK_ONE_STEP);
    if (flag >= 0 && obeys_equations(instance, erk, before, *time)) {
      instance->situation->statistics[STATISTIC_STEPS]++;
      resting = sundials_rests(before, *time - before) ? resting + 1 : 0;
      if (resting == RESTING_STEP_LIMIT) return resting_steps;
      ERKStepGetCurrentStep(erk->arkode, &trial);
      continue;
    }
    trial = 0.1 * fmin(trial, end - before);
    *time = before;
    N_VScale(1.0, erk->before, erk->vectors.state);
    if (sundials_rests(before, trial)) return "the equations have no solution there, or steps would be too short";
    if (!start(instance, erk, before, trial, end)) return "SUNDIALS does not start again";
  }
  return NULL;
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Erk *erk = instance->solver_memory;
  struct Situation *situation = instance->situation;
  double end = situation->time + length;
  if (sundials_tiny_step(instance, end)) return STEP_DONE;
  memcpy(N_VGetArrayPointer(erk->vectors.state), instance->state, lagrangian.state_count * sizeof(double));
  sundials_set_tolerances(instance, &erk->vectors, safety);
  realtype time = situation->time;
  if (!start(instance, erk, time, situation->suggested_step, end)) return STEP_FAILED;
  const char *problem = reach(instance, erk, &time, end);
  memcpy(instance->state, N_VGetArrayPointer(erk->vectors.state), lagrangian.state_count * sizeof(double));
  if (problem == NULL)
    return sundials_succeeded(instance, ERKStepGetCurrentStep(erk->arkode, &situation->suggested_step),
                              "ERKStepGetCurrentStep")
               ? STEP_DONE
               : STEP_FAILED;
  sundials_log_stop(instance, "ERKStep", problem, time, end);
  *reached = time;
  return STEP_PARTIAL;
}

const struct Solver solver_erk = {.allocates_by_itself = true, .create = create, .destroy = destroy, .step = step};
