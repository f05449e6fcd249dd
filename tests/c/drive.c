/*
 * Takes an FMU through its whole life cycle with valid and invalid calls, under sanitizers and valgrind. Repeats
 * that after the library is unloaded and loaded again: drive LIBRARY GUID REALS STATES. Prints the log. Fails if a
 * valid call fails, a value is not finite, or memory leaks.
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counted_memory.h"
#include "fmu_library.h"

static int failures;

static void print_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                          fmi2String message, ...) {
  char text[2000];
  va_list arguments;
  (void)environment;
  va_start(arguments, message);
  vsnprintf(text, sizeof text, message, arguments);
  va_end(arguments);
  if (name == NULL || category == NULL || status > fmi2Fatal) failures++;
  else printf("%d %s: %s\n", status, category, text);
}

static void expect(int right, const char *what) {
  if (right) return;
  fprintf(stderr, "not as expected: %s\n", what);
  failures++;
}
#define EXPECT(condition) expect(condition, #condition)

struct PrescribedMotion {
  struct FmuLibrary fmu;
  const char *guid;
  size_t reals, states;
};

static fmi2Component instantiate(const struct PrescribedMotion *prescribed_motion, fmi2Type type) {
  const fmi2CallbackFunctions callbacks = {print_message, count_allocation, count_free, NULL, NULL};
  fmi2Component c = prescribed_motion->fmu.fmi2Instantiate("drive", type, prescribed_motion->guid,
                                                           "file:///tmp/resources", &callbacks, fmi2False, fmi2True);
  EXPECT(c != NULL);
  return c;
}

static void initialize(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  EXPECT(prescribed_motion->fmu.fmi2SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2False, 0.0) == fmi2OK);
  EXPECT(prescribed_motion->fmu.fmi2EnterInitializationMode(c) == fmi2OK);
  EXPECT(prescribed_motion->fmu.fmi2ExitInitializationMode(c) == fmi2OK);
}

static void read_all(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  for (fmi2ValueReference vr = 0; vr < prescribed_motion->reals; vr++) {
    double value = NAN;
    EXPECT(prescribed_motion->fmu.fmi2GetReal(c, &vr, 1, &value) == fmi2OK);
    EXPECT(isfinite(value));
  }
}

/* Saves and restores the state, also by bytes. */
static void exercise_state(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  const struct FmuLibrary *fmu = &prescribed_motion->fmu;
  fmi2FMUstate state = NULL, copy = NULL;
  size_t size = 0;
  EXPECT(fmu->fmi2GetFMUstate(c, &state) == fmi2OK);
  EXPECT(fmu->fmi2GetFMUstate(c, &state) == fmi2OK);
  EXPECT(fmu->fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK);
  fmi2Byte *bytes = malloc(size);
  EXPECT(fmu->fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK);
  EXPECT(fmu->fmi2DeSerializeFMUstate(c, bytes, size, &copy) == fmi2OK);
  EXPECT(fmu->fmi2SetFMUstate(c, copy) == fmi2OK);
  bytes[size / 2] = (fmi2Byte)(bytes[size / 2] ^ 1);
  EXPECT(fmu->fmi2DeSerializeFMUstate(c, bytes, size, &copy) == fmi2Error);
  EXPECT(fmu->fmi2SetFMUstate(c, state) == fmi2OK);
  EXPECT(fmu->fmi2FreeFMUstate(c, &copy) == fmi2OK && copy == NULL);
  EXPECT(fmu->fmi2FreeFMUstate(c, &state) == fmi2OK && state == NULL);
  EXPECT(fmu->fmi2FreeFMUstate(c, &state) == fmi2OK);
  free(bytes);
}

static void co_simulate(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  const struct FmuLibrary *fmu = &prescribed_motion->fmu;
  initialize(prescribed_motion, c);
  for (int i = 0; i < 40; i++) {
    EXPECT(fmu->fmi2DoStep(c, 0.01 * i, 0.01, fmi2False) == fmi2OK);
    if (i == 20) exercise_state(prescribed_motion, c);
  }
  read_all(prescribed_motion, c);
  EXPECT(fmu->fmi2Terminate(c) == fmi2OK);
}

static void exchange_model(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  const struct FmuLibrary *fmu = &prescribed_motion->fmu;
  static double x[1024], derivative[1024], nominal[1024];
  EXPECT(prescribed_motion->states <= 1024);
  fmi2EventInfo event;
  fmi2Boolean enter_event, terminate;
  initialize(prescribed_motion, c);
  EXPECT(fmu->fmi2NewDiscreteStates(c, &event) == fmi2OK);
  EXPECT(fmu->fmi2EnterContinuousTimeMode(c) == fmi2OK);
  EXPECT(fmu->fmi2GetContinuousStates(c, x, prescribed_motion->states) == fmi2OK);
  EXPECT(fmu->fmi2GetNominalsOfContinuousStates(c, nominal, prescribed_motion->states) == fmi2OK);
  for (int i = 1; i <= 20; i++) {
    EXPECT(fmu->fmi2GetDerivatives(c, derivative, prescribed_motion->states) == fmi2OK);
    for (size_t k = 0; k < prescribed_motion->states; k++) x[k] += 1e-4 * derivative[k];
    EXPECT(fmu->fmi2SetTime(c, 1e-4 * i) == fmi2OK);
    EXPECT(fmu->fmi2SetContinuousStates(c, x, prescribed_motion->states) == fmi2OK);
    EXPECT(fmu->fmi2CompletedIntegratorStep(c, fmi2True, &enter_event, &terminate) == fmi2OK);
  }
  exercise_state(prescribed_motion, c);
  read_all(prescribed_motion, c);
  EXPECT(fmu->fmi2EnterEventMode(c) == fmi2OK);
  EXPECT(fmu->fmi2Terminate(c) == fmi2OK);
}

/* Makes calls in wrong states or with wrong arguments; each must return an error and do no harm. */
static void call_wrongly(const struct PrescribedMotion *prescribed_motion, fmi2Component c) {
  const struct FmuLibrary *fmu = &prescribed_motion->fmu;
  const fmi2ValueReference unknown = 100000;
  double value = NAN;
  fmi2FMUstate state = NULL;
  EXPECT(fmu->fmi2DoStep(c, 0, 0.1, fmi2True) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
  EXPECT(fmu->fmi2GetReal(c, &unknown, 1, &value) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
  EXPECT(fmu->fmi2SetReal(c, &unknown, 1, &value) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
  EXPECT(fmu->fmi2GetReal(c, NULL, 3, NULL) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
  EXPECT(fmu->fmi2DeSerializeFMUstate(c, "no state", 8, &state) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
  EXPECT(fmu->fmi2EnterInitializationMode(c) == fmi2Error);
  EXPECT(fmu->fmi2Reset(c) == fmi2OK);
}

static void live(struct PrescribedMotion *prescribed_motion, const char *path) {
  prescribed_motion->fmu = fmu_library_open(path);
  const fmi2CallbackFunctions callbacks = {print_message, count_allocation, count_free, NULL, NULL};
  EXPECT(prescribed_motion->fmu.fmi2Instantiate("drive", fmi2CoSimulation, "{wrong}", NULL, &callbacks, fmi2False,
                                                fmi2False) == NULL);
  fmi2Component c = instantiate(prescribed_motion, fmi2CoSimulation),
                second = instantiate(prescribed_motion, fmi2CoSimulation);
  for (int run = 0; run < 2; run++) {
    call_wrongly(prescribed_motion, c);
    co_simulate(prescribed_motion, c);
    EXPECT(prescribed_motion->fmu.fmi2Reset(c) == fmi2OK);
    co_simulate(prescribed_motion, second);
    EXPECT(prescribed_motion->fmu.fmi2Reset(second) == fmi2OK);
  }
  prescribed_motion->fmu.fmi2FreeInstance(c);
  prescribed_motion->fmu.fmi2FreeInstance(second);
  prescribed_motion->fmu.fmi2FreeInstance(NULL);
  c = instantiate(prescribed_motion, fmi2ModelExchange);
  exchange_model(prescribed_motion, c);
  prescribed_motion->fmu.fmi2FreeInstance(c);
  EXPECT(blocks == 0);
  fmu_library_close(&prescribed_motion->fmu);
}

int main(int count, char **words) {
  if (count != 5) return 2;
  struct PrescribedMotion prescribed_motion = {
      .guid = words[2], .reals = strtoul(words[3], NULL, 10), .states = strtoul(words[4], NULL, 10)};
  for (int load = 0; load < 2; load++) live(&prescribed_motion, words[1]);
  return failures > 0;
}
