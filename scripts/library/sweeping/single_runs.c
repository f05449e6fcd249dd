/*
 * The runs of a sweep: calls the functions of a loaded FMU for one set of values after another, and records results
 * during the run. A maximum between three samples is that of the parabola through them. An event separates the
 * samples; its time is found by bisection of the step, which restarts from a saved state. The run continues from the
 * end of the step.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "fmi2.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

struct Functions {
  fmi2Status (*reset)(fmi2Component component);
  fmi2Status (*setup)(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                      fmi2Boolean has_stop, fmi2Real stop);
  fmi2Status (*set)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                    const fmi2Real values[]);
  fmi2Status (*set_integer)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                            const fmi2Integer values[]);
  fmi2Status (*set_boolean)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                            const fmi2Boolean values[]);
  fmi2Status (*enter)(fmi2Component component);
  fmi2Status (*exit)(fmi2Component component);
  fmi2Status (*step)(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean is_final);
  fmi2Status (*get)(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[]);
  fmi2Status (*get_integer)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                            fmi2Integer values[]);
  fmi2Status (*save)(fmi2Component component, fmi2FMUstate *state);
  fmi2Status (*restore)(fmi2Component component, fmi2FMUstate state);
  fmi2Status (*forget)(fmi2Component component, fmi2FMUstate *state);
};

struct Variables {
  size_t count;
  const fmi2ValueReference *references;
};

enum RecordKind {
  RECORD_VALUE,
  RECORD_MAXIMUM,
  RECORD_MINIMUM,
  RECORD_EVENTS,
  RECORD_FIRST,
  RECORD_EVENTS_OF,
  RECORD_FIRST_OF
};

/*
 * A column of the result: the value of a sampled variable at a time, its maximum or minimum, or the number or first
 * time of events. Events are all, or those of the contact or friction with a name.
 */
struct Record {
  size_t kind, variable;
  double time;
  const char *name;
};

/* The task. Arrays of values have a row for each run. */
struct Sweep {
  struct Variables varied, integers, booleans, watched, ends, sampled; /* varied: those of type Real */
  const double *values;                                                /* of the varied variables: runs x varied */
  const int *integer_values, *boolean_values;                          /* likewise */
  double tolerance;                                                    /* 0: the FMU's own */
  size_t time_count;
  const double *times;      /* ends of the communication steps in s, ascending */
  struct Variables counter; /* the counter of events; none if their times are not needed */
  size_t record_count;
  const struct Record *records;
  double *recorded;             /* runs x records */
  double *samples;              /* workspace: 3 x sampled */
  double *before, *after;       /* of the watched variables: runs x watched, after initialization and at the end */
  double *end_values, *seconds; /* runs x ends; runs */
};

/* The run that listens to the log of its FMU; NULL while steps are repeated. */
static _Thread_local struct SweepRun *listener;

static double now(void) {
  struct timespec time;
  timespec_get(&time, TIME_UTC);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* A run in progress, with its last three samples since the last event, the newest first. */
struct SweepRun {
  const struct Functions *f;
  fmi2Component component;
  const struct Sweep *sweep;
  double *recorded; /* the row of the run */
  double time[3];
  size_t count;
};

/* Records an event of a contact or friction, from the FMU's message on it. */
static void record_switch(const struct SweepRun *course, const char *message) {
  char name[1000];
  double time;
  int end = 0;
  if (sscanf(message, "time %lf: '%999[^']' switches%n", &time, name, &end) != 2 || end == 0) return;
  for (size_t i = 0; i < course->sweep->record_count; i++) {
    const struct Record *record = &course->sweep->records[i];
    bool is_of = record->kind == RECORD_EVENTS_OF || record->kind == RECORD_FIRST_OF;
    if (!is_of || strcmp(record->name, name) != 0) continue;
    if (record->kind == RECORD_EVENTS_OF) course->recorded[i]++;
    else if (isnan(course->recorded[i])) course->recorded[i] = time;
  }
}

/* The FMU's logger: passes on problems to the logger in the environment. */
EXPORT void sweep_log(void *environment, fmi2String instance, fmi2Status status, fmi2String category,
                      fmi2String message, ...) {
  fmi2CallbackLogger logger;
  memcpy(&logger, environment, sizeof logger);
  if (status == fmi2OK && listener != NULL) record_switch(listener, message);
  else if (status != fmi2OK) logger(NULL, instance, status, category, message);
}

/* Returns the height of the vertex of the parabola through three samples above the middle one. */
static double excess_of(const double *time, double late, double middle, double early) {
  double before = (middle - early) / (time[1] - time[2]), after = (late - middle) / (time[0] - time[1]);
  double curvature = (after - before) / (time[0] - time[2]), slope = before + curvature * (time[1] - time[2]);
  return curvature < 0.0 ? -slope * slope / (4.0 * curvature) : 0.0;
}

/* Returns the largest value up to the newest sample, of the variable times a sign. */
static double peak_of(const struct SweepRun *course, size_t variable, double sign) {
  size_t n = course->sweep->sampled.count;
  const double *value = course->sweep->samples + variable;
  double late = sign * value[0];
  if (course->count < 3) return late;
  double middle = sign * value[n], early = sign * value[2 * n];
  if (middle < late || middle < early) return late;
  return fmax(late, middle + excess_of(course->time, late, middle, early));
}

static void record(const struct SweepRun *course, size_t i) {
  const struct Record *record = &course->sweep->records[i];
  double *result = &course->recorded[i];
  if (record->kind == RECORD_VALUE && record->time == course->time[0])
    *result = course->sweep->samples[record->variable];
  if (record->kind == RECORD_MAXIMUM) *result = fmax(*result, peak_of(course, record->variable, 1.0));
  if (record->kind == RECORD_MINIMUM) *result = fmin(*result, -peak_of(course, record->variable, -1.0));
}

/* Samples and records the present time. Returns false if values cannot be read. */
static bool sample(struct SweepRun *course, double time) {
  const struct Variables *sampled = &course->sweep->sampled;
  double *samples = course->sweep->samples;
  memmove(samples + sampled->count, samples, 2 * sampled->count * sizeof *samples);
  memmove(course->time + 1, course->time, 2 * sizeof *course->time);
  course->time[0] = time;
  if (course->count < 3) course->count++;
  if (course->f->get(course->component, sampled->references, sampled->count, samples) > fmi2Warning) return false;
  for (size_t i = 0; i < course->sweep->record_count; i++) record(course, i);
  return true;
}

static int events_of(const struct SweepRun *course) {
  const struct Variables *counter = &course->sweep->counter;
  fmi2Integer count = 0;
  if (counter->count > 0) course->f->get_integer(course->component, counter->references, 1, &count);
  return count;
}

/* Records the number of events until now, and the time of the first one. */
static void record_events(const struct SweepRun *course, double time, int count) {
  for (size_t i = 0; i < course->sweep->record_count; i++) {
    if (course->sweep->records[i].kind == RECORD_EVENTS) course->recorded[i] = count;
    if (course->sweep->records[i].kind == RECORD_FIRST && isnan(course->recorded[i])) course->recorded[i] = time;
  }
}

static bool go(const struct SweepRun *course, fmi2FMUstate state, double begin, double end) {
  return course->f->restore(course->component, state) <= fmi2Warning &&
         (end <= begin || course->f->step(course->component, begin, end - begin, fmi2False) <= fmi2Warning);
}

enum { EVENT_ROWS = 100 };         /* events of a step whose times are searched */
static const double found = 1e-10; /* accuracy of the times, relative to the step */

/*
 * Samples just before and after each event of the step from begin to end, from the saved state at begin with `count`
 * events. Leaves the FMU somewhere in the step. A step that is too short for the FMU ends the search.
 */
static void sample_events(struct SweepRun *course, fmi2FMUstate *state, double begin, double end, int total,
                          int count) {
  double enough = found * (end - begin);
  for (int i = 0; i < EVENT_ROWS && count < total; i++) {
    double low = begin, high = end;
    while (high - low > enough) {
      double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high || !go(course, *state, begin, middle)) break;
      if (events_of(course) == count) low = middle;
      else high = middle;
    }
    if (!go(course, *state, begin, low) || (low > course->time[0] && !sample(course, low))) return;
    course->count = 0;
    if (!go(course, *state, begin, high) || !sample(course, high)) return;
    count = events_of(course);
    record_events(course, high, count);
    begin = high;
    if (course->f->save(course->component, state) > fmi2Warning) return;
  }
}

/* Takes a communication step and records it. Returns NULL, or the name of the function that failed. */
static const char *step(struct SweepRun *course, double begin, double end) {
  const struct Functions *f = course->f;
  fmi2FMUstate first = NULL, last = NULL;
  bool looks = course->sweep->counter.count > 0, fails = looks && f->save(course->component, &first) > fmi2Warning;
  int before = events_of(course), after;
  listener = course;
  bool is_done = !fails && f->step(course->component, begin, end - begin, looks ? fmi2False : fmi2True) <= fmi2Warning;
  listener = NULL;
  if (!is_done) {
    if (first != NULL) f->forget(course->component, &first);
    return fails ? "fmi2GetFMUstate" : "fmi2DoStep";
  }
  after = events_of(course);
  if (after > before && f->save(course->component, &last) <= fmi2Warning) {
    sample_events(course, &first, begin, end, after, before);
    fails = f->restore(course->component, last) > fmi2Warning;
    record_events(course, end, after);
  }
  if (first != NULL) f->forget(course->component, &first);
  if (last != NULL) f->forget(course->component, &last);
  if (fails) return "fmi2SetFMUstate";
  bool is_sampled = course->sweep->sampled.count == 0 || course->time[0] == end || sample(course, end);
  return is_sampled ? NULL : "fmi2GetReal";
}

static void begin_records(const struct Sweep *sweep, double *recorded) {
  for (size_t i = 0; i < sweep->record_count; i++) {
    size_t kind = sweep->records[i].kind;
    recorded[i] = kind == RECORD_MAXIMUM                              ? -INFINITY
                  : kind == RECORD_MINIMUM                            ? INFINITY
                  : kind == RECORD_EVENTS || kind == RECORD_EVENTS_OF ? 0.0
                                                                      : NAN;
  }
}

/* Sets the varied variables of run k. Returns NULL, or the name of the function that failed. */
static const char *set_varied(const struct Functions *f, fmi2Component component, const struct Sweep *sweep, size_t k) {
  const struct Variables *varied = &sweep->varied, *integers = &sweep->integers, *booleans = &sweep->booleans;
  const int *integer_values = sweep->integer_values + k * integers->count;
  const int *boolean_values = sweep->boolean_values + k * booleans->count;
  if (f->set(component, varied->references, varied->count, sweep->values + k * varied->count) > fmi2Warning)
    return "fmi2SetReal";
  if (f->set_integer(component, integers->references, integers->count, integer_values) > fmi2Warning)
    return "fmi2SetInteger";
  if (f->set_boolean(component, booleans->references, booleans->count, boolean_values) > fmi2Warning)
    return "fmi2SetBoolean";
  return NULL;
}

/* Does run k. Returns NULL, or the name of the function that failed. */
static const char *run(const struct Functions *f, fmi2Component component, const struct Sweep *sweep, size_t k) {
  const struct Variables *watched = &sweep->watched, *ends = &sweep->ends;
  if (f->reset(component) > fmi2Warning) return "fmi2Reset";
  if (f->setup(component, sweep->tolerance > 0, sweep->tolerance, 0, fmi2False, 0) > fmi2Warning)
    return "fmi2SetupExperiment";
  const char *problem = set_varied(f, component, sweep, k);
  if (problem != NULL) return problem;
  if (f->enter(component) > fmi2Warning) return "fmi2EnterInitializationMode";
  if (f->exit(component) > fmi2Warning) return "fmi2ExitInitializationMode";
  if (f->get(component, watched->references, watched->count, sweep->before + k * watched->count) > fmi2Warning)
    return "fmi2GetReal";
  struct SweepRun course = {
      .f = f, .component = component, .sweep = sweep, .recorded = sweep->recorded + k * sweep->record_count};
  begin_records(sweep, course.recorded);
  if (sweep->sampled.count > 0 && !sample(&course, 0.0)) return "fmi2GetReal";
  for (size_t i = 0; i < sweep->time_count; i++) {
    const char *failed = step(&course, i > 0 ? sweep->times[i - 1] : 0.0, sweep->times[i]);
    if (failed != NULL) return failed;
  }
  if (f->get(component, ends->references, ends->count, sweep->end_values + k * ends->count) > fmi2Warning ||
      f->get(component, watched->references, watched->count, sweep->after + k * watched->count) > fmi2Warning)
    return "fmi2GetReal";
  return NULL;
}

/*
 * Computes the runs first .. count - 1. Returns count, or the run that failed, with the name of the function. Its
 * times are wall-clock times.
 */
EXPORT size_t sweep_runs(const struct Functions *functions, fmi2Component component, const struct Sweep *sweep,
                         size_t first, size_t count, const char **failed) {
  *failed = NULL;
  for (size_t k = first; k < count; k++) {
    double begin = now();
    *failed = run(functions, component, sweep, k);
    sweep->seconds[k] = now() - begin;
    if (*failed != NULL) return k;
  }
  return count;
}

/* Returns the number of lanes of src/ensemble that suits the processor's vectors. */
EXPORT int sweep_lanes(void) {
#ifdef __x86_64__
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return 8;
  if (__builtin_cpu_supports("avx2")) return 4;
#endif
  return 2;
}
