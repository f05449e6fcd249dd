/*
 * Times model exchange with CVODE, without Python. CVODE is configured as in FMPy: BDF, difference quotients for
 * the Jacobian matrix, steps up to a fiftieth of the time, and roots. Arguments and output are those of stepping,
 * with the numbers of states and indicators. STEPS is the number of calls of CVODE:
 *
 *   exchange LIBRARY GUID TOLERANCE END STEPS REPEATS OUTPUTS POINTS COUNTS STATES INDICATORS [REFERENCE=VALUE ...]
 */
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "measuring.h"

struct Importer {
  struct FmuLibrary fmu;
  fmi2Component component;
  size_t states, indicators;
  double tolerance;
  N_Vector x, absolute;
  void *cvode;
};

static int slot(const struct Importer *importer, double time, N_Vector x) {
  const struct FmuLibrary *fmu = &importer->fmu;
  return fmu->fmi2SetTime(importer->component, time) == fmi2OK &&
         fmu->fmi2SetContinuousStates(importer->component, N_VGetArrayPointer(x), importer->states) == fmi2OK;
}

static int right_side(double time, N_Vector x, N_Vector derivative, void *user) {
  const struct Importer *importer = user;
  double *values = N_VGetArrayPointer(derivative);
  return !slot(importer, time, x) ||
         importer->fmu.fmi2GetDerivatives(importer->component, values, importer->states) != fmi2OK;
}

static int roots(double time, N_Vector x, double *values, void *user) {
  const struct Importer *importer = user;
  return !slot(importer, time, x) ||
         importer->fmu.fmi2GetEventIndicators(importer->component, values, importer->indicators) != fmi2OK;
}

/* Iterates the event to convergence, then enters continuous-time mode with the new states. */
static int leave_event(const struct Importer *importer) {
  const struct FmuLibrary *fmu = &importer->fmu;
  fmi2EventInfo info = {.newDiscreteStatesNeeded = fmi2True};
  double *absolute = N_VGetArrayPointer(importer->absolute);
  while (info.newDiscreteStatesNeeded)
    if (fmu->fmi2NewDiscreteStates(importer->component, &info) != fmi2OK || info.terminateSimulation) return 0;
  if (fmu->fmi2EnterContinuousTimeMode(importer->component) != fmi2OK ||
      fmu->fmi2GetContinuousStates(importer->component, N_VGetArrayPointer(importer->x), importer->states) != fmi2OK ||
      fmu->fmi2GetNominalsOfContinuousStates(importer->component, absolute, importer->states) != fmi2OK)
    return 0;
  for (size_t i = 0; i < importer->states; i++) absolute[i] *= importer->tolerance;
  return 1;
}

/* Integrates to a time, with all events before it. */
static int go_to(struct Importer *importer, double end) {
  const struct FmuLibrary *fmu = &importer->fmu;
  for (double time = -1.0; time < end;) {
    int flag = CVode(importer->cvode, end, importer->x, &time, CV_NORMAL);
    fmi2Boolean has_event = fmi2False, is_over = fmi2False;
    if (flag < 0 || !slot(importer, time, importer->x) ||
        fmu->fmi2CompletedIntegratorStep(importer->component, fmi2True, &has_event, &is_over) != fmi2OK || is_over)
      return 0;
    if (flag != CV_ROOT_RETURN && !has_event) continue;
    if (fmu->fmi2EnterEventMode(importer->component) != fmi2OK || !leave_event(importer) ||
        CVodeReInit(importer->cvode, time, importer->x) != CV_SUCCESS)
      return 0;
  }
  return 1;
}

/* Returns the seconds of a run that prints up to `points` points; negative on failure. */
static double run(struct Importer *importer, double end, long steps, long points, const char *outputs) {
  struct Moment start = moment();
  if (!leave_event(importer) || CVodeReInit(importer->cvode, 0.0, importer->x) != CV_SUCCESS) return -1.0;
  for (long k = 0; k < steps; k++) {
    if (!go_to(importer, end * (double)(k + 1) / (double)steps)) return -1.0;
    if ((k + 1) * points % steps < points && !print_outputs(&importer->fmu, importer->component, outputs)) return -1.0;
  }
  return seconds_since(start);
}

static bool create(struct Importer *importer, SUNContext context, double end) {
  sunindextype n = (sunindextype)importer->states;
  SUNMatrix matrix = SUNDenseMatrix(n, n, context);
  importer->x = N_VNew_Serial(n, context);
  importer->absolute = N_VNew_Serial(n, context);
  importer->cvode = CVodeCreate(CV_BDF, context);
  N_VConst(importer->tolerance, importer->absolute);
  return CVodeInit(importer->cvode, right_side, 0.0, importer->x) == CV_SUCCESS &&
         CVodeSetUserData(importer->cvode, importer) == CV_SUCCESS &&
         CVodeSVtolerances(importer->cvode, importer->tolerance, importer->absolute) == CV_SUCCESS &&
         CVodeRootInit(importer->cvode, (int)importer->indicators, roots) == CV_SUCCESS &&
         CVodeSetLinearSolver(importer->cvode, SUNLinSol_Dense(importer->x, matrix, context), matrix) == CV_SUCCESS &&
         CVodeSetMaxStep(importer->cvode, end / 50.0) == CV_SUCCESS &&
         CVodeSetMaxNumSteps(importer->cvode, 100000) == CV_SUCCESS &&
         CVodeSetNoInactiveRootWarn(importer->cvode) == CV_SUCCESS;
}

/* Memory of SUNDIALS is freed with the process. */
int main(int count, char **words) {
  if (count < 12) return 2;
  struct Importer importer = {.fmu = fmu_library_open(words[1]), .tolerance = strtod(words[3], NULL)};
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  double end = strtod(words[4], NULL), best = 1e300;
  long steps = strtol(words[5], NULL, 10), repeats = strtol(words[6], NULL, 10);
  long points = strtol(words[8], NULL, 10);
  importer.states = strtoul(words[10], NULL, 10);
  importer.indicators = strtoul(words[11], NULL, 10);
  importer.component =
      importer.fmu.fmi2Instantiate("bench", fmi2ModelExchange, words[2], NULL, &callbacks, fmi2False, fmi2False);
  SUNContext context;
  if (importer.component == NULL || SUNContext_Create(NULL, &context) != 0 || !create(&importer, context, end))
    return 1;
  for (long i = points > 0 ? -1 : 0; i < repeats; i++) {
    if (!initialize(&importer.fmu, importer.component, importer.tolerance, count - 12, words + 12)) return 1;
    double taken = run(&importer, end, steps, i < 0 ? points : 0, words[7]);
    if (taken < 0.0) return 1;
    if ((i >= 0 || repeats == 0) && taken < best) best = taken;
  }
  printf("%.9g\n", best);
  if (!print_counts(&importer.fmu, importer.component, words[9])) return 1;
  importer.fmu.fmi2FreeInstance(importer.component);
  fmu_library_close(&importer.fmu);
  return 0;
}
