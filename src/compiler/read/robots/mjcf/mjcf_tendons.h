/* <tendon>: what couples joints by a sum of their positions. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* Reads one element in it, once all joints are known. */
void mjcf_read_tendon(struct Mjcf *mjcf, xmlNodePtr node);

/* The one of this name; NULL after reporting that there is none. */
const struct Tendon *mjcf_tendon(struct Mjcf *mjcf, xmlNodePtr node, const char *name);
