/*
 * Backward differentiation formulas (BDF) of orders 1 to 5, by CVODE of SUNDIALS, with the generated Jacobian. The
 * solver continues over communication steps, and restarts only after changes from outside.
 *
 * Measurements against alternatives: with inputs that change at every communication step, ESDIRK547L2SA of ARKODE
 * reaches equal errors in half the time. Without such changes it takes 3 to 5 times as long. Continuing over an input's
 * change without a restart takes more steps, loses digits, and finally fails.
 */
#include "methods/sundials/bdf_support.h"

#include <math.h>

#include <cvode/cvode.h>

#include "evaluation/services.h"

/* Fraction of the tolerance for one step: errors of many steps add up (tests/solvers/test_motion.py). */
static const double safety = 0.01;

static int fill_jacobian(realtype time, N_Vector state, N_Vector derivative, SUNMatrix matrix, void *data,
                         N_Vector unused1, N_Vector unused2, N_Vector unused3) {
  struct Instance *instance = data;
  const struct Bdf *bdf = instance->solver_memory;
  (void)derivative;
  (void)unused1;
  (void)unused2;
  (void)unused3;
  if (!solver_jacobian(instance, time, N_VGetArrayPointer(state), bdf->jacobian)) return 1;
  bdf->fill(bdf, matrix);
  return 0;
}

/* Computes the change that projects a state onto the constraints. */
static int correction_to_constraints(realtype time, N_Vector state, N_Vector correction, realtype tolerance,
                                     N_Vector error, void *data) {
  struct Instance *instance = data;
  (void)tolerance;
  (void)error;
  N_VScale(1.0, state, correction);
  if (solver_project(instance, time, N_VGetArrayPointer(correction)) != NULL) return 1;
  N_VLinearSum(1.0, correction, -1.0, state, correction);
  return 0;
}

/*
 * Projects the states after steps, but not their error estimates: an error that the projection removes is an error of
 * the step.
 */
static bool keep_constraints(struct Instance *instance, const struct Bdf *bdf) {
  return lagrangian.constraints.projection == NULL ||
         (SUCCEEDS(instance, CVodeSetProjFn, bdf->cvode, correction_to_constraints) &&
          SUCCEEDS(instance, CVodeSetProjErrEst, bdf->cvode, 0));
}

static bool set_tolerances(struct Instance *instance, const struct Bdf *bdf) {
  return SUCCEEDS(instance, CVodeSVtolerances, bdf->cvode, bdf->sundials.relative, bdf->sundials.tolerance);
}

bool bdf_configure(struct Instance *instance) {
  struct Bdf *bdf = instance->solver_memory;
  if (bdf->matrix == NULL || bdf->linear_solver == NULL) return false;
  sundials_load(instance, instance->state, safety);
  bdf->jacobian = sundials_allocate(lagrangian.implicit.pattern.count, sizeof *bdf->jacobian);
  bdf->cvode = CVodeCreate(CV_BDF, bdf->sundials.context);
  return bdf->cvode != NULL && SUCCEEDS(instance, CVodeSetErrHandlerFn, bdf->cvode, sundials_ignore_error, NULL) &&
         SUCCEEDS(instance, CVodeInit, bdf->cvode, sundials_right_side, instance->fmu_state->time,
                  bdf->sundials.state) &&
         set_tolerances(instance, bdf) && SUCCEEDS(instance, CVodeSetUserData, bdf->cvode, instance) &&
         SUCCEEDS(instance, CVodeSetMaxNumSteps, bdf->cvode, lagrangian.steps.max_steps) &&
         keep_constraints(instance, bdf) && SUCCEEDS(instance, CVodeSetMaxHnilWarns, bdf->cvode, -1) &&
         SUCCEEDS(instance, CVodeSetLinearSolver, bdf->cvode, bdf->linear_solver, bdf->matrix) &&
         SUCCEEDS(instance, CVodeSetJacFn, bdf->cvode, fill_jacobian);
}

bool bdf_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  const struct Bdf *bdf = instance->solver_memory;
  (void)step;
  sundials_load(instance, state, safety);
  return SUCCEEDS(instance, CVodeReInit, bdf->cvode, instance->fmu_state->last_step.end, bdf->sundials.state) &&
         set_tolerances(instance, bdf);
}

/*
 * Returns the longest step: with inputs or time in the equations, one beyond the communication step could miss a pulse.
 */
static double longest_step(const struct CommunicationStep *step) {
  bool is_forced = lagrangian.input_count > 0 || lagrangian.steps.depends_on_time;
  return is_forced ? fmin(step->length, lagrangian.steps.max_step) : lagrangian.steps.max_step;
}

/*
 * Bounds the next step by the functions in the equations. bound lies beyond what CVODE takes: at most ten times the
 * last step, except for the first ones. Returns NULL, or the reason for a failure.
 */
static const char *limit_by_functions(struct Instance *instance, const struct Bdf *bdf, double time, double end) {
  double last = 0.0;
  if (CVodeGetLastStep(bdf->cvode, &last) < 0) return "CVODE failed to return its last step";
  double bound = last > 0.0 ? 100.0 * last : 2.0 * (end - time);
  double longest = sundials_longest_step(instance, time, bound);
  if (longest < bound && solver_step_vanishes(time, longest)) return solver_vanished_step;
  return CVodeSetStopTime(bdf->cvode, time + longest) >= 0 ? NULL : "CVODE failed to set the stop time";
}

const char *bdf_advance(struct Instance *instance, const struct CommunicationStep *step) {
  const struct Bdf *bdf = instance->solver_memory;
  struct FmuState *fmu_state = instance->fmu_state;
  double before = fmu_state->last_step.end, time = before;
  if (sundials_tiny_step(instance, step)) return NULL;
  if (CVodeSetMaxStep(bdf->cvode, longest_step(step)) < 0) return "CVODE failed to set the longest step";
  const char *problem = lagrangian.taylor.limit == NULL ? NULL : limit_by_functions(instance, bdf, before, step->end);
  if (problem != NULL) return problem;
  double made = 0.0;
  if (CVode(bdf->cvode, step->end, bdf->sundials.state, &time, CV_ONE_STEP) < 0) return "steps were rejected too often";
  if (CVodeGetLastStep(bdf->cvode, &made) < 0) return "CVODE failed to return its last step";
  /* CVODE accepts steps that are too short to change the time, as where a root ends. */
  if (made > 0.0 && before + made == before) return solver_vanished_step;
  fmu_state->last_step = (struct Span){before, time};
  fmu_state->statistics[STATISTIC_STEPS]++;
  return NULL;
}

bool bdf_interpolate(struct Instance *instance, double time, double *state) {
  const struct Bdf *bdf = instance->solver_memory;
  return sundials_interpolate(instance, CVodeGetDky, bdf->cvode, time, state);
}
