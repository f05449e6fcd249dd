/* When an interface lets a function be called. Each interface has a table of these. */
#ifndef LIFE_CYCLE_H
#define LIFE_CYCLE_H

#include "instance/instance.h"

#define IN(mode) (1u << (mode))

enum {
  FOR_EXCHANGE = 1 << KIND_MODEL_EXCHANGE,
  FOR_STEPS = 1 << KIND_CO_SIMULATION,
  FOR_BOTH = FOR_EXCHANGE | FOR_STEPS
};

/* The modes of one kind are never reached by instances of the other, so that one set of modes serves both. */
struct Permission {
  unsigned kinds, modes;
};

/* Whether the function may be called now; logs an error under its name where it may not. */
bool is_permitted(struct Instance *instance, const struct Permission *permission, const char *function);

#endif
