/* <tendon>: fixed tendons, linear combinations of joint positions, and spatial ones through sites. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Reads a tendon, once all joints are known. */
void mjcf_read_tendon(struct Mjcf *mjcf, xmlNodePtr node);

/* Returns the tendon of this name; NULL after reporting that there is none. */
const struct Tendon *mjcf_tendon(struct Mjcf *mjcf, xmlNodePtr node, const char *name);
