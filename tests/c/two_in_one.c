/*
 * Links two FMUs of C sources into one program, steps both in turn and prints the first two outputs of each:
 * two_in_one GUID GUID STEPS STEP. FIRST and SECOND are the FMUs' names, with which their functions begin.
 */
#include <stdio.h>
#include <stdlib.h>

#include "fmi2.h"

#define PASTE(name, function) name##_##function
#define OF(name, function) PASTE(name, function)
#define DECLARE(name)                                                                                                  \
  __typeof__(fmi2Instantiate) OF(name, fmi2Instantiate);                                                               \
  __typeof__(fmi2SetupExperiment) OF(name, fmi2SetupExperiment);                                                       \
  __typeof__(fmi2EnterInitializationMode) OF(name, fmi2EnterInitializationMode);                                       \
  __typeof__(fmi2ExitInitializationMode) OF(name, fmi2ExitInitializationMode);                                         \
  __typeof__(fmi2DoStep) OF(name, fmi2DoStep);                                                                         \
  __typeof__(fmi2GetReal) OF(name, fmi2GetReal);                                                                       \
  __typeof__(fmi2FreeInstance) OF(name, fmi2FreeInstance);
DECLARE(FIRST)
DECLARE(SECOND)

static void check(fmi2Status status) {
  if (status != fmi2OK) exit(1);
}

#define START(name, guid)                                                                                              \
  OF(name, fmi2Instantiate)("instance", fmi2CoSimulation, guid, NULL, &callbacks, fmi2False, fmi2False);               \
  check(OF(name, fmi2SetupExperiment)(name, fmi2False, 0.0, 0.0, fmi2False, 0.0));                                     \
  check(OF(name, fmi2EnterInitializationMode)(name));                                                                  \
  check(OF(name, fmi2ExitInitializationMode)(name))

#define PRINT(name)                                                                                                    \
  check(OF(name, fmi2GetReal)(name, references, 2, values));                                                           \
  printf("%.17g %.17g\n", values[0], values[1]);                                                                       \
  OF(name, fmi2FreeInstance)(name)

int main(int count, char **words) {
  if (count != 5) return 2;
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  const fmi2ValueReference references[] = {0, 1};
  double values[2], step = atof(words[4]);
  fmi2Component FIRST = START(FIRST, words[1]);
  fmi2Component SECOND = START(SECOND, words[2]);
  for (int i = 0; i < atoi(words[3]); i++) {
    check(OF(FIRST, fmi2DoStep)(FIRST, i * step, step, fmi2True));
    check(OF(SECOND, fmi2DoStep)(SECOND, i * step, step, fmi2True));
  }
  PRINT(FIRST);
  PRINT(SECOND);
  return 0;
}
