/* <actuator>: forces on joints and tendons that depend on a control. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Reads an actuator, once all joints and tendons are known. */
void mjcf_read_actuator(struct Mjcf *mjcf, xmlNodePtr node);
