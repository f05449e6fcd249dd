/*
 * 8 threads step 8 instances in turn, under ThreadSanitizer: threads LIBRARY GUID. Fails if a call fails, or if
 * instances with equal calls end in different states.
 */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmu_library.h"

enum { THREADS = 8, INSTANCES = 8, STEPS = 50 };

static struct FmuLibrary fmu;
static const char *guid;

static void no_logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                      fmi2String message, ...) {
  (void)environment;
  (void)name;
  (void)status;
  (void)category;
  (void)message;
}

struct Work {
  pthread_t thread;
  double ends[INSTANCES]; /* the first variable, an output or a state, after the last step */
  int failed;
};

static void *work(void *argument) {
  const fmi2CallbackFunctions callbacks = {no_logger, calloc, free, NULL, NULL};
  struct Work *own = argument;
  fmi2Component c[INSTANCES];
  const fmi2ValueReference first = 0;
  for (int i = 0; i < INSTANCES; i++) {
    c[i] = fmu.fmi2Instantiate("thread", fmi2CoSimulation, guid, NULL, &callbacks, fmi2False, fmi2True);
    own->failed |= c[i] == NULL || fmu.fmi2SetupExperiment(c[i], fmi2True, 1e-6, 0.0, fmi2False, 0.0) != fmi2OK ||
                   fmu.fmi2EnterInitializationMode(c[i]) != fmi2OK || fmu.fmi2ExitInitializationMode(c[i]) != fmi2OK;
  }
  for (int step = 0; step < STEPS && !own->failed; step++)
    for (int i = 0; i < INSTANCES; i++) {
      fmi2FMUstate state = NULL;
      own->failed |= fmu.fmi2DoStep(c[i], 0.01 * step, 0.01, fmi2False) != fmi2OK ||
                     fmu.fmi2GetFMUstate(c[i], &state) != fmi2OK || fmu.fmi2FreeFMUstate(c[i], &state) != fmi2OK ||
                     fmu.fmi2GetReal(c[i], &first, 1, &own->ends[i]) != fmi2OK;
    }
  for (int i = 0; i < INSTANCES; i++) fmu.fmi2FreeInstance(c[i]);
  return NULL;
}

int main(int count, char **words) {
  static struct Work works[THREADS];
  if (count != 3) return 2;
  fmu = fmu_library_open(words[1]);
  guid = words[2];
  for (int i = 0; i < THREADS; i++)
    if (pthread_create(&works[i].thread, NULL, work, &works[i]) != 0) return 2;
  int failed = 0;
  for (int i = 0; i < THREADS; i++) {
    pthread_join(works[i].thread, NULL);
    failed |= works[i].failed || memcmp(works[i].ends, works[0].ends, sizeof works[0].ends) != 0;
    for (int k = 1; k < INSTANCES; k++) failed |= works[i].ends[k] != works[i].ends[0];
  }
  if (failed) fputs("a call failed, or instances disagree\n", stderr);
  fmu_library_close(&fmu);
  return failed;
}
