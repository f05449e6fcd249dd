#include "timing/samples.h"

#include <float.h>
#include <math.h>

#include "nonsmooth/resolution.h"
#include "instance/time_laws.h"
#include "timing/time_events.h"

/* Returns the number of the first sample from a time on; the quotient alone may be off by rounding. */
static double first_count(double time, double offset, double period) {
  double count = fmax(0.0, floor((time - offset) / period));
  double latest = time - rounding_of_time(time);
  while (offset + count * period < latest) count += 1.0;
  return count;
}

/* An invalid period, which conditions.c reports, becomes 0, and the sample is at the present time. */
void samples_start(struct Instance *instance) {
  const struct SwitchTable *switches = lagrangian.switches;
  struct Resolution resolution = resolution_of(instance);
  double time = instance->fmu_state->time;
  time_events_values(&resolution, time);
  for (size_t i = 0; i < switches->sample_count; i++) {
    const struct SampleMetadata *sample = &switches->samples[i];
    double period = resolution.value[sample_slot(switches, i, SAMPLE_EVERY)];
    double offset = resolution.value[sample_slot(switches, i, SAMPLE_OFFSET)];
    bool is_right = is_period(period, offset, time);
    instance->parameter[sample->base] = is_right ? offset : time;
    instance->parameter[sample->count] = is_right ? first_count(time, offset, period) : 0.0;
    instance->parameter[sample->period] = is_right ? period : 0.0;
  }
}
