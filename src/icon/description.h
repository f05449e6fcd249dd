/* What the icon needs to know of an FMU, from its modelDescription.xml. */
#ifndef DESCRIPTION_H
#define DESCRIPTION_H

#include <stdbool.h>

#include "fmi2.h"

struct Description {
  char *guid;
  double stop_time;
  bool has_states;
  double states;                   /* how many */
  fmi2ValueReference solver_steps; /* where it has states: how many the solver has taken */
  fmi2ValueReference shown[2];     /* the first coordinate and its velocity, or the first input and the first output */
};

/* False after a message where the file cannot be read or shows nothing. Free with description_free(). */
bool description_read(const char *path, struct Description *description);
void description_free(struct Description *description);

#endif
