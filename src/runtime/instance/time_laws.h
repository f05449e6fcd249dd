/* Time events, whose times are known in advance. FMUs without any do not link it. */
#pragma once

#include <float.h>
#include <math.h>

#include "instance/instance.h"

/* Returns the distance in s below which two event times at this time are the same. */
static inline double rounding_of_time(double time) {
  return 4.0 * DBL_EPSILON * fabs(time);
}

/* True if a sample may have this period and offset at a time: the period is positive and not lost in rounding. */
static inline bool is_period(double period, double offset, double time) {
  return period > 0.0 && isfinite(period) && isfinite(offset) && time + period > time;
}

/* The functions of timing/. */
struct TimeLaws {
  /* Finds the next time, from the present on, at which a branch that depends only on time switches. False for none. */
  bool (*next)(struct Instance *instance, double *time);
  /* True if such a branch switches at the present time, to rounding. */
  bool (*is_due)(struct Instance *instance);
  /* Starts the samples at the present time. */
  void (*start)(struct Instance *instance);
};

/* Returns the time of the next sample; rounding errors do not add up over the samples. */
static inline double sample_time(const struct Instance *instance, const struct SampleMetadata *sample) {
  const double *mode = instance->parameter;
  return mode[sample->base] + mode[sample->count] * mode[sample->period];
}

extern const struct TimeLaws time_laws;

/* Returns the first sample after a time; INFINITY for none. */
static inline double next_sample(const struct Instance *instance, double time) {
  const struct SwitchTable *switches = lagrangian.switches;
  double next = INFINITY;
  for (size_t i = 0; switches != NULL && i < switches->sample_count; i++) {
    double sample = sample_time(instance, &switches->samples[i]);
    if (sample > time) next = fmin(next, sample);
  }
  return next;
}
