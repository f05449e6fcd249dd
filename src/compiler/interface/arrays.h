/* Arrays among the variables of an FMU, for FMI 3.0. */
#pragma once

#include "interface/interface.h"

/*
 * Finds arrays: consecutive variables q[1], q[2], ... q[N], as <for> makes them, and der(q[1]), ... with them. They
 * must differ only in their start values, and no other variable may have the array's name. If several variables of one
 * <for> alternate among the states, they remain scalars.
 */
void arrays_find(struct Interface *interface);

/* Returns the name of the variable, or of the array that begins with it. */
char *array_name(const struct InterfaceVariable *variable);

/* Returns its description; NULL for none. */
char *array_description(const struct InterfaceVariable *variable);
