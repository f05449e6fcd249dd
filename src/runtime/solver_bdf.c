/*
 * Backward differentiation formulas of order 1 to 5, by CVODE of SUNDIALS, with the generated Jacobian. The solver
 * goes on from one communication step to the next and starts anew only where something was changed from outside.
 *
 * Measured, and left: with inputs that change at every communication step, ESDIRK547L2SA of ARKODE reaches equal errors
 * in half the time, but it takes 3 to 5 times as long where nothing changes. Going on across the change of an input
 * without a new start takes more steps, loses digits, and fails in the end.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "log.h"
#include "solver.h"
#include "sundials_support.h"

/* Local errors of the order of the tolerance add up to more than it; see tests/test_motion.py. */
static const double safety = 0.01;

struct Bdf {
  struct SundialsVectors vectors;
  void *cvode;
  SUNMatrix matrix;
  SUNLinearSolver linear_solver;
};

static int right_side(realtype time, N_Vector state, N_Vector derivative, void *instance) {
  bool exists = solver_derivatives(instance, time, N_VGetArrayPointer(state), N_VGetArrayPointer(derivative));
  return exists ? 0 : 1; /* recoverable: a shorter step may avoid the point */
}

static int jacobian(realtype time, N_Vector state, N_Vector derivative, SUNMatrix matrix, void *data, N_Vector unused1,
                    N_Vector unused2, N_Vector unused3) {
  struct Instance *instance = data;
  (void)derivative;
  (void)unused1;
  (void)unused2;
  (void)unused3;
  struct Point point = solver_point(instance, time, N_VGetArrayPointer(state));
  instance->situation->statistics[STATISTIC_JACOBIANS]++;
  instance->singular = lagrangian.jacobian(&point, SUNDenseMatrix_Data(matrix));
  return instance->singular == 0 ? 0 : 1;
}

static void destroy(struct Instance *instance) {
  struct Bdf *bdf = instance->solver_memory;
  if (bdf->cvode != NULL) CVodeFree(&bdf->cvode);
  if (bdf->linear_solver != NULL) SUNLinSolFree(bdf->linear_solver);
  if (bdf->matrix != NULL) SUNMatDestroy(bdf->matrix);
  sundials_vectors_destroy(instance, &bdf->vectors);
  instance->free(bdf);
  instance->solver_memory = NULL;
}

static bool configure(struct Instance *instance, struct Bdf *bdf) {
  sunindextype n = (sunindextype)lagrangian.state_count;
  bdf->cvode = CVodeCreate(CV_BDF, bdf->vectors.context);
  bdf->matrix = SUNDenseMatrix(n, n, bdf->vectors.context);
  bdf->linear_solver = SUNLinSol_Dense(bdf->vectors.state, bdf->matrix, bdf->vectors.context);
  if (bdf->cvode == NULL || bdf->matrix == NULL || bdf->linear_solver == NULL) return false;
  sundials_set_tolerances(instance, &bdf->vectors, safety);
  return sundials_succeeded(instance, CVodeSetErrHandlerFn(bdf->cvode, sundials_ignore_error, NULL),
                            "CVodeSetErrHandlerFn") &&
         sundials_succeeded(instance, CVodeInit(bdf->cvode, right_side, instance->situation->time, bdf->vectors.state),
                            "CVodeInit") &&
         sundials_succeeded(instance, CVodeSVtolerances(bdf->cvode, bdf->vectors.relative, bdf->vectors.tolerance),
                            "CVodeSVtolerances") &&
         sundials_succeeded(instance, CVodeSetUserData(bdf->cvode, instance), "CVodeSetUserData") &&
         sundials_succeeded(instance, CVodeSetMaxNumSteps(bdf->cvode, STEP_LIMIT), "CVodeSetMaxNumSteps") &&
         sundials_succeeded(instance, CVodeSetMaxHnilWarns(bdf->cvode, -1), "CVodeSetMaxHnilWarns") &&
         sundials_succeeded(instance, CVodeSetLinearSolver(bdf->cvode, bdf->linear_solver, bdf->matrix),
                            "CVodeSetLinearSolver") &&
         sundials_succeeded(instance, CVodeSetJacFn(bdf->cvode, jacobian), "CVodeSetJacFn");
}

static bool create(struct Instance *instance) {
  struct Bdf *bdf = instance->allocate(1, sizeof *bdf);
  if (bdf == NULL) {
    log_message(instance, fmi2Error, "allocateMemory returned no memory for the solver");
    return false;
  }
  instance->solver_memory = bdf;
  if (sundials_vectors_create(instance, &bdf->vectors)) {
    memcpy(N_VGetArrayPointer(bdf->vectors.state), instance->state, lagrangian.state_count * sizeof(double));
    if (configure(instance, bdf)) return true;
  }
  destroy(instance);
  return false;
}

static bool restart(struct Instance *instance, struct Bdf *bdf) {
  memcpy(N_VGetArrayPointer(bdf->vectors.state), instance->state, lagrangian.state_count * sizeof(double));
  sundials_set_tolerances(instance, &bdf->vectors, safety);
  return sundials_succeeded(instance, CVodeReInit(bdf->cvode, instance->situation->time, bdf->vectors.state),
                            "CVodeReInit") &&
         sundials_succeeded(instance, CVodeSVtolerances(bdf->cvode, bdf->vectors.relative, bdf->vectors.tolerance),
                            "CVodeSVtolerances");
}

/* Where inputs or time drive the system, a step longer than the communication step could pass over a pulse. */
static bool limit_step(struct Instance *instance, struct Bdf *bdf, double communication_step) {
  bool driven = lagrangian.input_count > 0 || lagrangian.depends_on_time;
  double longest = driven ? fmin(communication_step, lagrangian.max_step) : lagrangian.max_step;
  return sundials_succeeded(instance, CVodeSetMaxStep(bdf->cvode, longest), "CVodeSetMaxStep");
}

/*
 * Bounds the next step; but for the first ones, the method makes none that is more than ten times as long as the last.
 * NULL, or the reason why there is no step.
 */
static const char *limit_by_functions(struct Instance *instance, struct Bdf *bdf, double time, double end) {
  N_Vector state = bdf->vectors.state;
  double last = 0.0;
  /* At the start of a communication step, the vector holds the state of its start. */
  bool has_state = time <= instance->situation->time || CVodeGetDky(bdf->cvode, time, 0, state) >= 0;
  if (!has_state || CVodeGetLastStep(bdf->cvode, &last) < 0) return "SUNDIALS has no state there";
  double bound = last > 0.0 ? 100.0 * last : 2.0 * (end - time);
  double longest = sundials_longest_step(instance, &bdf->vectors, time, N_VGetArrayPointer(state), bound);
  if (longest < bound && sundials_rests(time, longest)) return resting_steps;
  return CVodeSetStopTime(bdf->cvode, time + longest) >= 0 ? NULL : "SUNDIALS does not take a time to stop at";
}

/*
 * Goes step by step to the end or past it: an interpolation gives the state there. NULL, or the reason why the state
 * stays at *time before the end.
 */
static const char *reach(struct Instance *instance, struct Bdf *bdf, double *time, double end) {
  int resting = 0;
  for (long steps = 0; *time < end; steps++) {
    if (steps == STEP_LIMIT) return "too many steps";
    double before = *time;
    const char *problem = lagrangian.limit == NULL ? NULL : limit_by_functions(instance, bdf, before, end);
    if (problem != NULL) return problem;
    if (CVode(bdf->cvode, end, bdf->vectors.state, time, CV_ONE_STEP) < 0) return "no step is short enough";
    instance->situation->statistics[STATISTIC_STEPS]++;
    resting = sundials_rests(before, *time - before) ? resting + 1 : 0;
    if (resting == RESTING_STEP_LIMIT) return resting_steps;
  }
  return NULL;
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Bdf *bdf = instance->solver_memory;
  struct Situation *situation = instance->situation;
  double end = situation->time + length;
  if (sundials_tiny_step(instance, end)) return STEP_DONE;
  if ((instance->solver_is_stale || situation->changed) && !restart(instance, bdf)) return STEP_FAILED;
  if (!limit_step(instance, bdf, length)) return STEP_FAILED;
  instance->solver_is_stale = false;
  situation->changed = 0;
  realtype time = situation->time;
  if (!sundials_succeeded(instance, CVodeGetCurrentTime(bdf->cvode, &time), "CVodeGetCurrentTime")) return STEP_FAILED;
  const char *problem = reach(instance, bdf, &time, end);
  if (problem == NULL) {
    if (!sundials_succeeded(instance, CVodeGetDky(bdf->cvode, end, 0, bdf->vectors.state), "CVodeGetDky"))
      return STEP_FAILED;
    memcpy(instance->state, N_VGetArrayPointer(bdf->vectors.state), lagrangian.state_count * sizeof(double));
    return STEP_DONE;
  }
  memcpy(instance->state, N_VGetArrayPointer(bdf->vectors.state), lagrangian.state_count * sizeof(double));
  sundials_log_stop(instance, "CVODE", problem, time, end);
  instance->solver_is_stale = true;
  *reached = time;
  return STEP_PARTIAL;
}

const struct Solver solver_bdf = {.allocates_by_itself = true, .create = create, .destroy = destroy, .step = step};
