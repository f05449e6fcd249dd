/* Arrays among the variables of an FMU, for FMI 3.0. */
#pragma once

#include "interface/interface.h"

/*
 * Marks the variables q[1], q[2], ... q[N] that follow each other, as <for> makes them, and der(q[1]), ... with them, as the
 * elements of one array where they differ in their start values alone and no other variable has the array's name. Where
 * several variables of one <for> stand by turns among the states, they remain scalars.
 */
void arrays_find(struct Interface *interface);

/* The name of the variable, or of the array that begins with it. */
char *array_name(const struct InterfaceVariable *variable);

/* Its description; NULL for none. */
char *array_description(const struct InterfaceVariable *variable);
