/*
 * Lets each allocation of a simulation fail in turn, alone, and then with all that follow: out_of_memory LIBRARY
 * GUID OUTPUT. OUTPUT is the value reference of an output. Fails if no message mentions memory, if memory leaks, or
 * if the instance does not simulate after a reset like a new one.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "counted_memory.h"
#include "fmu_library.h"

enum { STEPS = 12 };

static struct FmuLibrary fmu;
static const char *guid;
static fmi2ValueReference output;

static long count;          /* number of allocations so far */
static long first_failure;  /* number of the first allocation to fail */
static bool all_later_fail; /* those after it fail, too */
static bool may_fail;       /* false: all allocations succeed */
static bool is_reported;    /* a message mentioned memory */

static void *allocate(size_t number, size_t size) {
  count++;
  bool fails = may_fail && (all_later_fail ? count >= first_failure : count == first_failure);
  return fails ? NULL : count_allocation(number, size);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...) {
  (void)environment;
  (void)name;
  (void)category;
  if (status == fmi2Error && strstr(message, "memory") != NULL) is_reported = true;
}

/* Saves and restores the state by its bytes. */
static bool save_and_restore(fmi2Component c) {
  fmi2FMUstate state = NULL, copy = NULL;
  size_t size = 0;
  fmi2Byte *bytes = NULL;
  bool done = fmu.fmi2GetFMUstate(c, &state) == fmi2OK && fmu.fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK &&
              (bytes = malloc(size)) != NULL && fmu.fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK &&
              fmu.fmi2DeSerializeFMUstate(c, bytes, size, &copy) == fmi2OK && fmu.fmi2SetFMUstate(c, copy) == fmi2OK;
  fmu.fmi2FreeFMUstate(c, &copy);
  fmu.fmi2FreeFMUstate(c, &state);
  free(bytes);
  return done;
}

/* Simulates a new or reset instance, and returns the output after the last step in *end. Returns false on an error. */
static bool simulate(fmi2Component c, double *end) {
  const fmi2Integer order = 1;
  double derivative, time = 0.0;
  if (fmu.fmi2SetupExperiment(c, fmi2True, 1e-6, 0.0, fmi2False, 0.0) != fmi2OK ||
      fmu.fmi2EnterInitializationMode(c) != fmi2OK || fmu.fmi2ExitInitializationMode(c) != fmi2OK)
    return false;
  for (int i = 0; i < STEPS; i++) {
    double size = 0.01 * (1 + i % 3);
    if (fmu.fmi2DoStep(c, time, size, fmi2False) != fmi2OK ||
        fmu.fmi2GetRealOutputDerivatives(c, &output, 1, &order, &derivative) != fmi2OK ||
        (i == STEPS / 2 && !save_and_restore(c)))
      return false;
    time += size;
  }
  return fmu.fmi2GetReal(c, &output, 1, end) == fmi2OK;
}

static bool expect(bool right, const char *what) {
  if (!right)
    fprintf(stderr, "allocation %ld failed%s: %s\n", first_failure, all_later_fail ? " with all that follow" : "",
            what);
  return right;
}

/* Simulates with failing allocations; after a failure, resets and simulates without. */
static bool survives(double expected) {
  const fmi2CallbackFunctions callbacks = {logger, allocate, count_free, NULL, NULL};
  double end = 0.0;
  count = blocks = 0;
  is_reported = false;
  may_fail = true;
  fmi2Component c = fmu.fmi2Instantiate("memory", fmi2CoSimulation, guid, NULL, &callbacks, fmi2False, fmi2True);
  bool simulated = c != NULL && simulate(c, &end), reached = count >= first_failure;
  bool right =
      expect(simulated != reached, reached ? "no error" : "an error") && expect(is_reported == reached, "no message");
  may_fail = false;
  if (right && c != NULL && reached)
    right = expect(fmu.fmi2Reset(c) == fmi2OK && simulate(c, &end), "no simulation after a reset");
  right = right && (c == NULL || expect(end == expected, "another end"));
  fmu.fmi2FreeInstance(c);
  return expect(blocks == 0, "memory not given back") && right;
}

int main(int words_count, char **words) {
  if (words_count != 4) return 2;
  fmu = fmu_library_open(words[1]);
  guid = words[2];
  output = (fmi2ValueReference)strtoul(words[3], NULL, 10);
  const fmi2CallbackFunctions callbacks = {logger, allocate, count_free, NULL, NULL};
  double expected = 0.0;
  fmi2Component c = fmu.fmi2Instantiate("memory", fmi2CoSimulation, guid, NULL, &callbacks, fmi2False, fmi2True);
  bool right = c != NULL && expect(simulate(c, &expected), "an error");
  fmu.fmi2FreeInstance(c);
  long all = count;
  for (long number = 1; number <= all && right; number++)
    for (int for_good = 0; for_good < 2 && right; for_good++) {
      first_failure = number;
      all_later_fail = for_good != 0;
      right = survives(expected);
    }
  printf("%ld allocations\n", all);
  fmu_library_close(&fmu);
  return !right;
}
