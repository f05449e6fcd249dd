/* Attributes of MJCF that are not read: each that changes the motion is warned of. */
#pragma once

#include "read/robots/mjcf/mjcf_values.h"

void mjcf_check_attributes(struct Mjcf *mjcf);
