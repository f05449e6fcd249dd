/* An instance of FMI 2.0: the core, and the caller's callbacks. */
#pragma once

#include "fmi2.h"
#include "instance/instance.h"

/* An fmi2Component points to this; the instance is its first member. */
struct FmiComponent {
  struct Instance instance;
  fmi2CallbackLogger logger;
  fmi2ComponentEnvironment environment;
  const char *name;
  unsigned categories; /* bits of the enabled log categories */
};

/* Returns the receiver of the component's messages. */
struct Log log_of(struct FmiComponent *component);

/* Returns the status for the caller. */
static inline fmi2Status status_of(enum Status status) {
  static const fmi2Status of[] = {[STATUS_DONE] = fmi2OK,
                                  [STATUS_WARNING] = fmi2Warning,
                                  [STATUS_DISCARD] = fmi2Discard,
                                  [STATUS_ERROR] = fmi2Error};
  return of[status];
}
