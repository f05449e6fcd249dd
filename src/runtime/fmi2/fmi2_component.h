/* An instance as FMI 2.0 sees it: its core, and what its caller has handed over. */
#ifndef FMI2_COMPONENT_H
#define FMI2_COMPONENT_H

#include "fmi2.h"
#include "instance/instance.h"

/* What an fmi2Component points to. */
struct Component {
  struct Instance instance;
  fmi2CallbackLogger logger;
  fmi2ComponentEnvironment environment;
  const char *name;
  unsigned categories; /* bits of the log categories that are enabled */
};

/* Where the component's messages go. */
struct Log log_of(struct Component *component);

/* The status that the caller sees. */
static inline fmi2Status status_of(enum Status status) {
  static const fmi2Status of[] = {[STATUS_DONE] = fmi2OK,
                                  [STATUS_WARNING] = fmi2Warning,
                                  [STATUS_DISCARD] = fmi2Discard,
                                  [STATUS_ERROR] = fmi2Error};
  return of[status];
}

#endif
