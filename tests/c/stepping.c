/*
 * Times the steps of an FMU in processor time: stepping LIBRARY GUID TOLERANCE END STEPS REPEATS OUTPUTS POINTS COUNTS
 * [REFERENCE=VALUE ...] [REFERENCE~AMPLITUDE]. Prints a line with the Real variables OUTPUTS for each of up to
 * POINTS evenly spaced communication points. The seconds of the fastest repeat follow, then a line with the Integer
 * variables COUNTS. Both are comma-separated lists of references. An input with an amplitude changes before every
 * step. Points are printed in a run of their own: with 0 REPEATS that is the timed one, with 0 POINTS there is
 * none.
 */
#include <stdio.h>
#include <stdlib.h>

#include "measuring.h"

struct ChangingInput {
  fmi2ValueReference reference;
  double amplitude; /* 0 for none */
};

/* Sets the changing input as changing_input() of scripts/numerics/driver.py: eleven levels in turn. */
static int change(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, long k) {
  double value = input.amplitude * (double)(7 * k % 11 - 5) / 5.0;
  return input.amplitude == 0.0 || fmu->fmi2SetReal(c, &input.reference, 1, &value) == fmi2OK;
}

/* Removes and returns the last argument if it is REFERENCE~AMPLITUDE. */
static struct ChangingInput take_changing_input(int *count, char **words) {
  char *rest;
  fmi2ValueReference reference = (fmi2ValueReference)strtoul(words[*count - 1], &rest, 10);
  if (*rest != '~') return (struct ChangingInput){0, 0.0};
  --*count;
  return (struct ChangingInput){reference, strtod(rest + 1, NULL)};
}

static int step(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, double end, long k,
                long steps) {
  double from = end * (double)k / (double)steps, to = end * (double)(k + 1) / (double)steps;
  return change(fmu, c, input, k) && fmu->fmi2DoStep(c, from, to - from, fmi2True) == fmi2OK;
}

/* Returns the seconds of a run that prints up to `points` points; negative on failure. */
static double run(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, double end, long steps,
                  long points, const char *outputs) {
  struct Moment start = moment();
  for (long k = 0; k < steps; k++) {
    if (!step(fmu, c, input, end, k, steps)) return -1.0;
    if ((k + 1) * points % steps < points && !print_outputs(fmu, c, outputs)) return -1.0;
  }
  return seconds_since(start);
}

int main(int count, char **words) {
  if (count < 10) return 2;
  struct ChangingInput input = take_changing_input(&count, words);
  struct FmuLibrary fmu = fmu_library_open(words[1]);
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  double tolerance = strtod(words[3], NULL), end = strtod(words[4], NULL), best = 1e300;
  long steps = strtol(words[5], NULL, 10), repeats = strtol(words[6], NULL, 10);
  long points = strtol(words[8], NULL, 10);
  fmi2Component c = fmu.fmi2Instantiate("bench", fmi2CoSimulation, words[2], NULL, &callbacks, fmi2False, fmi2False);
  if (c == NULL) return 1;
  for (long i = points > 0 ? -1 : 0; i < repeats; i++) {
    if (!initialize(&fmu, c, tolerance, count - 10, words + 10)) return 1;
    double taken = run(&fmu, c, input, end, steps, i < 0 ? points : 0, words[7]);
    if (taken < 0.0) return 1;
    if ((i >= 0 || repeats == 0) && taken < best) best = taken;
  }
  printf("%.9g\n", best);
  if (!print_counts(&fmu, c, words[9])) return 1;
  fmu.fmi2FreeInstance(c);
  fmu_library_close(&fmu);
  return 0;
}
