/* Switches whose times are known beforehand: time events. FMUs without any do not hold it. */
#ifndef TIME_LAWS_H
#define TIME_LAWS_H

#include <float.h>
#include <math.h>

#include "instance/instance.h"

/* In s: how far from an event at this time another one may be that is meant to be the same. */
static inline double rounding_of_time(double time) {
  return 4.0 * DBL_EPSILON * fabs(time);
}

/* Whether a sample can have this period and offset at a time: the period is above 0, and not lost against the time. */
static inline bool is_period(double period, double offset, double time) {
  return period > 0.0 && isfinite(period) && isfinite(offset) && time + period > time;
}

struct TimeLaws {
  /* Finds the next time, from that of the situation on, at which time alone turns a branch. False for none. */
  bool (*next)(struct Instance *instance, double *time);
  /* True if the time of the situation is, to rounding, one at which time alone turns a branch. */
  bool (*is_due)(struct Instance *instance);
  /* Lets the samples begin at the time of the situation. */
  void (*start)(struct Instance *instance);
};

/* The time of the next sample, as a number: what rounding leaves of it, and nothing more. */
static inline double sample_time(const struct Instance *instance, const struct SampleFacts *sample) {
  const double *mode = instance->parameter;
  return mode[sample->base] + mode[sample->count] * mode[sample->period];
}

extern const struct TimeLaws time_laws;

/* The time of the first sample behind a time; INFINITY for none. */
static inline double next_sample(const struct Instance *instance, double time) {
  const struct SwitchTable *switches = lagrangian.switches;
  double next = INFINITY;
  for (size_t i = 0; switches != NULL && i < switches->sample_count; i++) {
    double sample = sample_time(instance, &switches->samples[i]);
    if (sample > time) next = fmin(next, sample);
  }
  return next;
}

#endif
