/* Warns of MJCF attributes that are not read and may change the motion. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

void mjcf_check_attributes(struct Mjcf *mjcf);
