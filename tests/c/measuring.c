#include "measuring.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Times below are taken by the wall clock, in s. */
static const double short_time = 1e-3;

static double seconds_of(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct Moment moment(void) {
  return (struct Moment){seconds_of(CLOCK_MONOTONIC), seconds_of(CLOCK_PROCESS_CPUTIME_ID)};
}

double seconds_since(struct Moment begin) {
  struct Moment now = moment();
  double passed = now.machine - begin.machine;
  return passed < short_time ? passed : now.processor - begin.processor;
}

int initialize(const struct FmuLibrary *fmu, fmi2Component c, double tolerance, int count, char **starts) {
  if (fmu->fmi2Reset(c) != fmi2OK || fmu->fmi2SetupExperiment(c, fmi2True, tolerance, 0.0, fmi2False, 0.0) != fmi2OK)
    return 0;
  for (int i = 0; i < count; i++) {
    char *rest;
    fmi2ValueReference reference = (fmi2ValueReference)strtoul(starts[i], &rest, 10);
    double value = strtod(rest + 1, NULL);
    if (fmu->fmi2SetReal(c, &reference, 1, &value) != fmi2OK) return 0;
  }
  return fmu->fmi2EnterInitializationMode(c) == fmi2OK && fmu->fmi2ExitInitializationMode(c) == fmi2OK;
}

/* Removes the next reference from the list. Returns 0 if there is none. */
static int next_reference(const char **references, fmi2ValueReference *reference) {
  char *rest;
  *reference = (fmi2ValueReference)strtoul(*references, &rest, 10);
  if (rest == *references) return 0;
  *references = *rest == ',' ? rest + 1 : rest;
  return 1;
}

int print_outputs(const struct FmuLibrary *fmu, fmi2Component c, const char *references) {
  fmi2ValueReference reference;
  while (next_reference(&references, &reference)) {
    double value;
    if (fmu->fmi2GetReal(c, &reference, 1, &value) != fmi2OK) return 0;
    printf("%.17g ", value);
  }
  putchar('\n');
  return 1;
}

int print_counts(const struct FmuLibrary *fmu, fmi2Component c, const char *references) {
  fmi2ValueReference reference;
  while (next_reference(&references, &reference)) {
    fmi2Integer value;
    if (fmu->fmi2GetInteger(c, &reference, 1, &value) != fmi2OK) return 0;
    printf("%d ", value);
  }
  putchar('\n');
  return 1;
}
