/*
 * Times the communication steps of an FMU one by one: realtime LIBRARY GUID RESOURCES STEP COUNT RUNS SECONDS.
 * Takes COUNT steps of STEP s in each of RUNS runs of at most SECONDS. Prints the number of steps, then times in
 * ns, then the number of allocations. Of each step the fastest time in all runs is taken, which excludes
 * interruptions: median, 99.9 % quantile and maximum. The last time is the maximum of all. A call of getppid marks
 * begin and end of the steps for strace.
 */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "fmu_library.h"

static long allocations;

static void *allocate(size_t count, size_t size) {
  allocations++;
  return calloc(count, size);
}

static void ignore(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String format, ...) {
  (void)environment, (void)name, (void)status, (void)category, (void)format;
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

struct Experiment {
  double step, seconds;
  size_t count;
};

/* Returns the number of steps; taken[] has the time of each. */
static size_t run(const struct FmuLibrary *fmu, fmi2Component c, const struct Experiment *experiment, double *taken) {
  size_t i = 0;
  double begin = now(), before = begin;
  fmi2Status status = fmi2OK;
  while (i < experiment->count && status == fmi2OK && before - begin < experiment->seconds) {
    status = fmu->fmi2DoStep(c, (double)i * experiment->step, experiment->step, fmi2True);
    double after = now();
    taken[i] = after - before;
    before = after;
    if (status == fmi2OK) i++;
  }
  return i;
}

static int compare(const void *first, const void *second) {
  double a = *(const double *)first, b = *(const double *)second;
  return (a > b) - (a < b);
}

static int start(const struct FmuLibrary *fmu, fmi2Component c) {
  return fmu->fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) <= fmi2Warning &&
         fmu->fmi2EnterInitializationMode(c) <= fmi2Warning && fmu->fmi2ExitInitializationMode(c) <= fmi2Warning;
}

/* Times over all runs. */
struct Times {
  double *taken;  /* of each step in the present run */
  double *least;  /* of each step, the shortest of all runs */
  double longest; /* of all steps */
  size_t steps;   /* number of steps of a run */
  long allocations;
};

static struct Times times_create(size_t count) {
  struct Times times = {
      .taken = malloc(count * sizeof(double)), .least = malloc(count * sizeof(double)), .steps = count};
  if (times.taken == NULL || times.least == NULL) exit(1);
  for (size_t i = 0; i < count; i++) times.taken[i] = times.least[i] = 1e9; /* touches all pages before the steps */
  return times;
}

static void add_run(struct Times *times, const struct FmuLibrary *fmu, fmi2Component c,
                    const struct Experiment *experiment) {
  allocations = 0;
  syscall(SYS_getppid);
  size_t steps = run(fmu, c, experiment, times->taken);
  syscall(SYS_getppid);
  times->allocations += allocations;
  if (steps < times->steps) times->steps = steps;
  for (size_t i = 0; i < times->steps; i++) {
    if (times->taken[i] > times->longest) times->longest = times->taken[i];
    if (times->taken[i] < times->least[i]) times->least[i] = times->taken[i];
  }
}

static void print_times(struct Times *times) {
  size_t last = times->steps - 1;
  qsort(times->least, times->steps, sizeof(double), compare);
  printf("%zu,%.0f,%.0f,%.0f,%.0f,%ld\n", times->steps, 1e9 * times->least[last / 2],
         1e9 * times->least[last - last / 1000], 1e9 * times->least[last], 1e9 * times->longest, times->allocations);
}

int main(int count, char **words) {
  if (count != 8) return 2;
  struct FmuLibrary fmu = fmu_library_open(words[1]);
  static const fmi2CallbackFunctions callbacks = {ignore, allocate, free, NULL, NULL};
  fmi2Component c =
      fmu.fmi2Instantiate("realtime", fmi2CoSimulation, words[2], words[3], &callbacks, fmi2False, fmi2False);
  if (c == NULL) return 1;
  struct Experiment experiment = {strtod(words[4], NULL), strtod(words[7], NULL), strtoul(words[5], NULL, 10)};
  struct Times times = times_create(experiment.count);
  for (long runs = strtol(words[6], NULL, 10); runs > 0 && times.steps > 0; runs--) {
    if (!start(&fmu, c)) return 1;
    add_run(&times, &fmu, c, &experiment);
    if (fmu.fmi2Reset(c) != fmi2OK) return 1;
  }
  if (times.steps == 0) return 1;
  print_times(&times);
  free(times.taken);
  free(times.least);
  fmu.fmi2FreeInstance(c);
  fmu_library_close(&fmu);
  return 0;
}
