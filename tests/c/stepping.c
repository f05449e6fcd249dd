/*
 * Times the steps of an FMU, by the processor's time: stepping LIBRARY GUID TOLERANCE END STEPS REPEATS OUTPUTS POINTS COUNTS
 * [REFERENCE=VALUE ...] [REFERENCE~AMPLITUDE]. Prints a line with the first OUTPUTS variables for each of up to POINTS
 * communication points that are evenly spaced, then the seconds of the fastest repeat, then a line with the Integer
 * variables whose references COUNTS lists. What has an amplitude is an input that changes before every step. Points are
 * printed in a run of their own: with 0 REPEATS that is the timed one, with 0 POINTS there is none.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmu_library.h"

/* Of the processor, which other work on the machine hardly lengthens. */
static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct ChangingInput {
  fmi2ValueReference reference;
  double amplitude; /* 0 for none */
};

/* The same values as changing_input() of scripts/numerics/driver.py: eleven levels, by turns. */
static int change(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, long k) {
  double value = input.amplitude * (double)(7 * k % 11 - 5) / 5.0;
  return input.amplitude == 0.0 || fmu->fmi2SetReal(c, &input.reference, 1, &value) == fmi2OK;
}

/* Takes the last word where it is REFERENCE~AMPLITUDE, and leaves one word less. */
static struct ChangingInput take_changing_input(int *count, char **words) {
  char *rest;
  fmi2ValueReference reference = (fmi2ValueReference)strtoul(words[*count - 1], &rest, 10);
  if (*rest != '~') return (struct ChangingInput){0, 0.0};
  --*count;
  return (struct ChangingInput){reference, strtod(rest + 1, NULL)};
}

static int prepare(const struct FmuLibrary *fmu, fmi2Component c, double tolerance, int count, char **starts) {
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

static int step(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, double end, long k,
                long steps) {
  double from = end * (double)k / (double)steps, to = end * (double)(k + 1) / (double)steps;
  return change(fmu, c, input, k) && fmu->fmi2DoStep(c, from, to - from, fmi2True) == fmi2OK;
}

static int print_outputs(const struct FmuLibrary *fmu, fmi2Component c, long outputs) {
  for (fmi2ValueReference reference = 0; reference < (fmi2ValueReference)outputs; reference++) {
    double value;
    if (fmu->fmi2GetReal(c, &reference, 1, &value) != fmi2OK) return 0;
    printf("%.17g ", value);
  }
  putchar('\n');
  return 1;
}

static int print_counts(const struct FmuLibrary *fmu, fmi2Component c, const char *references) {
  char *rest;
  for (fmi2ValueReference reference = (fmi2ValueReference)strtoul(references, &rest, 10); rest != references;
       reference = (fmi2ValueReference)strtoul(references, &rest, 10)) {
    fmi2Integer value;
    if (fmu->fmi2GetInteger(c, &reference, 1, &value) != fmi2OK) return 0;
    printf("%d ", value);
    references = *rest == ',' ? rest + 1 : rest;
  }
  putchar('\n');
  return 1;
}

/* The seconds of a run in which up to so many points are printed; negative where the FMU gives up. */
static double run(const struct FmuLibrary *fmu, fmi2Component c, struct ChangingInput input, double end, long steps,
                  long points, long outputs) {
  double start = seconds();
  for (long k = 0; k < steps; k++) {
    if (!step(fmu, c, input, end, k, steps)) return -1.0;
    if ((k + 1) * points % steps < points && !print_outputs(fmu, c, outputs)) return -1.0;
  }
  return seconds() - start;
}

int main(int count, char **words) {
  if (count < 10) return 2;
  struct ChangingInput input = take_changing_input(&count, words);
  struct FmuLibrary fmu = fmu_library_open(words[1]);
  const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
  double tolerance = strtod(words[3], NULL), end = strtod(words[4], NULL), best = 1e300;
  long steps = strtol(words[5], NULL, 10), repeats = strtol(words[6], NULL, 10), outputs = strtol(words[7], NULL, 10);
  long points = strtol(words[8], NULL, 10);
  fmi2Component c = fmu.fmi2Instantiate("bench", fmi2CoSimulation, words[2], NULL, &callbacks, fmi2False, fmi2False);
  if (c == NULL) return 1;
  for (long i = points > 0 ? -1 : 0; i < repeats; i++) {
    if (!prepare(&fmu, c, tolerance, count - 10, words + 10)) return 1;
    double taken = run(&fmu, c, input, end, steps, i < 0 ? points : 0, outputs);
    if (taken < 0.0) return 1;
    if ((i >= 0 || repeats == 0) && taken < best) best = taken;
  }
  printf("%.9g\n", best);
  if (!print_counts(&fmu, c, words[9])) return 1;
  fmu.fmi2FreeInstance(c);
  fmu_library_close(&fmu);
  return 0;
}
