/* Elements of <equality>, which are soft in MuJoCo and exact here: joints that follow others, and loops that are closed. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* Reads one of them, once all bodies, sites and joints are known. */
void mjcf_read_equality(struct Mjcf *mjcf, xmlNodePtr node);
