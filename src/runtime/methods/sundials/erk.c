/*
 * The explicit Runge-Kutta method of Dormand and Prince, of order 5(4), by ERKStep of SUNDIALS. The solver restarts at
 * every communication step, from the state and the step size in the snapshot, so that results depend on nothing else.
 */
#include <math.h>

#include <arkode/arkode_erkstep.h>

#include "methods/sundials/sundials_support.h"

#include "evaluation/services.h"

/* Fraction of the tolerance for one step: errors of many steps add up (tests/solvers/test_motion.py). */
static const double safety = 0.1;

/* Memory of the method; sundials is its first member. */
struct Erk {
  struct Sundials sundials;
  N_Vector before; /* at the start of the step */
  N_Vector rate;   /* workspace of obeys_equations() */
  double trial;    /* the next step, in s */
  void *arkode;
};

/* Projects the end of a step onto the constraints. */
static int keep_constraints(realtype time, N_Vector state, void *data) {
  return solver_project(data, time, N_VGetArrayPointer(state)) == NULL ? 0 : -1;
}

static bool configure(struct Instance *instance) {
  struct Erk *erk = instance->solver_memory;
  /* With events, the motion continues from states inside a step; otherwise those are only reported. */
  int degree = lagrangian.event_laws != NULL ? 5 : 3;
  SUNContext context = erk->sundials.context;
  erk->before = N_VClone(erk->sundials.state);
  erk->rate = N_VClone(erk->sundials.state);
  erk->arkode = ERKStepCreate(sundials_right_side, instance->fmu_state->time, erk->sundials.state, context);
  return erk->arkode != NULL && SUCCEEDS(instance, ERKStepSetErrHandlerFn, erk->arkode, sundials_ignore_error, NULL) &&
         SUCCEEDS(instance, ERKStepSetUserData, erk->arkode, instance) &&
         SUCCEEDS(instance, ERKStepSetTableNum, erk->arkode, ARKODE_DORMAND_PRINCE_7_4_5) &&
         SUCCEEDS(instance, ERKStepSetMaxNumSteps, erk->arkode, lagrangian.steps.max_steps) &&
         SUCCEEDS(instance, ERKStepSetMaxStep, erk->arkode, lagrangian.steps.max_step) &&
         (lagrangian.constraints.projection == NULL ||
          SUCCEEDS(instance, ERKStepSetPostprocessStepFn, erk->arkode, keep_constraints)) &&
         SUCCEEDS(instance, ERKStepSetMaxHnilWarns, erk->arkode, -1) &&
         SUCCEEDS(instance, ERKStepSetInterpolantDegree, erk->arkode, degree);
}

static bool create(struct Instance *instance) {
  return sundials_create(instance, sizeof(struct Erk), configure);
}

/* Starts the method at a time, from its state. first: the first step in s; 0 lets ERKStep choose. It stops at end. */
static bool start_method(struct Instance *instance, struct Erk *erk, double time, double first, double end) {
  const struct Sundials *sundials = &erk->sundials;
  return SUCCEEDS(instance, ERKStepReInit, erk->arkode, sundials_right_side, time, sundials->state) &&
         SUCCEEDS(instance, ERKStepSVtolerances, erk->arkode, sundials->relative, sundials->tolerance) &&
         SUCCEEDS(instance, ERKStepSetInitStep, erk->arkode, fmin(first, end - time)) &&
         SUCCEEDS(instance, ERKStepSetStopTime, erk->arkode, end);
}

/*
 * True if two values of the derivative of state i differ by more than half their size. They must also differ by
 * more than 20 times what the tolerance allows over the step.
 */
static bool differ(const struct Sundials *sundials, size_t i, double step, double one, double other) {
  double weight =
      sundials->relative * fabs(N_VGetArrayPointer(sundials->state)[i]) + N_VGetArrayPointer(sundials->tolerance)[i];
  double difference = fabs(one - other);
  return difference > 0.5 * fmax(fabs(one), fabs(other)) && step * difference > 20.0 * weight;
}

/* True if the derivatives at both ends of the last step are alike, as in most steps. */
static bool is_steady(const struct Erk *erk, double before, double time) {
  N_Vector first = erk->sundials.inside, last = erk->rate;
  if (ERKStepGetDky(erk->arkode, before, 1, first) < 0 || ERKStepGetDky(erk->arkode, time, 1, last) < 0) return false;
  for (size_t i = 0; i < lagrangian.state_count; i++)
    if (differ(&erk->sundials, i, time - before, N_VGetArrayPointer(first)[i], N_VGetArrayPointer(last)[i]))
      return false;
  return true;
}

/*
 * True if the dense output of the last step obeys the equations, at SAMPLES points inside it. The error estimate sees
 * the right side at few points, and may accept a step across a singularity.
 */
static bool obeys_equations(struct Instance *instance, const struct Erk *erk, double before, double time) {
  enum { SAMPLES = 8 };
  double *derivative = instance->work + lagrangian.input_count;
  if (is_steady(erk, before, time)) return true;
  for (int k = 0; k < SAMPLES; k++) {
    double slot = before + (k + 0.5) / SAMPLES * (time - before);
    N_Vector inside = erk->sundials.inside;
    if (ERKStepGetDky(erk->arkode, slot, 0, inside) < 0 || ERKStepGetDky(erk->arkode, slot, 1, erk->rate) < 0 ||
        !solver_derivatives_beyond(instance, slot, N_VGetArrayPointer(inside), derivative))
      return false;
    for (size_t i = 0; i < lagrangian.state_count; i++)
      if (differ(&erk->sundials, i, time - before, derivative[i], N_VGetArrayPointer(erk->rate)[i])) return false;
  }
  return true;
}

static bool restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Erk *erk = instance->solver_memory;
  sundials_load(instance, state, safety);
  erk->trial = step->end - step->start;
  return start_method(instance, erk, instance->fmu_state->last_step.end, instance->fmu_state->suggested_step,
                      step->end);
}

/*
 * A step fails if a stage has no right side or the polynomial does not obey the equations. A tenth of it is then
 * tried, down to the resolution of time.
 */
static const char *advance(struct Instance *instance, const struct CommunicationStep *step) {
  struct Erk *erk = instance->solver_memory;
  struct FmuState *fmu_state = instance->fmu_state;
  N_Vector state = erk->sundials.state;
  double before = fmu_state->last_step.end, rest = step->end - before, time = before;
  if (sundials_tiny_step(instance, step)) return NULL;
  double longest = sundials_longest_step(instance, before, rest);
  if (longest < rest && solver_step_vanishes(before, longest)) return solver_vanished_step;
  N_VScale(1.0, state, erk->before);
  for (;;) {
    ERKStepSetStopTime(erk->arkode, fmin(before + longest, step->end));
    int flag = ERKStepEvolve(erk->arkode, step->end, state, &time, ARK_ONE_STEP);
    if (flag >= 0 && obeys_equations(instance, erk, before, time)) break;
    erk->trial = 0.1 * fmin(erk->trial, rest);
    N_VScale(1.0, erk->before, state);
    if (solver_step_vanishes(before, erk->trial))
      return "the equations have no solution, or the step size fell below the resolution of time";
    if (!start_method(instance, erk, before, erk->trial, step->end)) return "ERKStep cannot be restarted";
  }
  ERKStepGetCurrentStep(erk->arkode, &erk->trial);
  fmu_state->suggested_step = erk->trial;
  fmu_state->last_step = (struct Span){before, time};
  fmu_state->statistics[STATISTIC_STEPS]++;
  return NULL;
}

static bool interpolate(struct Instance *instance, double time, double *state) {
  const struct Erk *erk = instance->solver_memory;
  return sundials_interpolate(instance, ERKStepGetDky, erk->arkode, time, state);
}

const struct Solver solver_erk = {.name = "ERKStep",
                                  .alternatives = "auto where rates differ much",
                                  .finer = "<solver method=\"taylor\"/>",
                                  .starts_anew = true,
                                  .run = sundials_run,
                                  .create = create,
                                  .destroy = sundials_destroy,
                                  .restart = restart,
                                  .advance = advance,
                                  .interpolate = interpolate};
