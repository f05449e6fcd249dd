/* <equality>: joints and tendons that follow others, and kinematic loops. Soft in MuJoCo, exact constraints here. */
#pragma once

#include "robots/mjcf/mjcf_values.h"

/* Reads an equality, once all bodies, sites and joints are known. */
void mjcf_read_equality(struct Mjcf *mjcf, xmlNodePtr node);
