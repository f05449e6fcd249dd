/* Switches whose times are known beforehand: time events. FMUs without any do not hold it. */
#ifndef TIME_LAWS_H
#define TIME_LAWS_H

#include "instance/instance.h"

struct TimeLaws {
  /* Finds the next time, from that of the situation on, at which time alone turns a branch. False for none. */
  bool (*next)(struct Instance *instance, double *time);
  /* True if the time of the situation is, to rounding, one at which time alone turns a branch. */
  bool (*is_due)(struct Instance *instance);
};

extern const struct TimeLaws time_laws;

#endif
