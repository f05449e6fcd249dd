/* Where a robot starts: a <key> of its <keyframe>. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

/* Gives the joints and actuators the start values of the key that the options name, once all of them are read; reports one that is not there. */
void mjcf_read_keyframe(struct Mjcf *mjcf);
