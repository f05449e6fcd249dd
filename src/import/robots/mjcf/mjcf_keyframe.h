/* <keyframe>: start values of a robot. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/*
 * Sets the start values of joints and actuators to those of the <key> that the options name; called after all of them
 * are read. Reports a missing key.
 */
void mjcf_read_keyframe(struct Mjcf *mjcf);
