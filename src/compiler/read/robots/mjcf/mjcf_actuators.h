/* <actuator>: what pushes a joint or tendon by its control. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* Reads one element in it, once all joints and tendons are known. */
void mjcf_read_actuator(struct Mjcf *mjcf, xmlNodePtr node);
