/* What is told of an instance: in initialization mode its start, between steps what the next one begins with. */
#ifndef READING_H
#define READING_H

#include "instance/instance.h"

/* Between these two, variables have the values that they are told with; nothing may be set. */
void reading_begin(struct Instance *instance, const char *function);
void reading_end(struct Instance *instance);

#endif
