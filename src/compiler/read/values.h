/* Values of variables that are given outside of systems, such as "30deg", "pi/2" or "0.5". */
#pragma once

#include <stdbool.h>

#include "base/diagnostics.h"

/*
 * Reads a value: an expression of numbers, or a number and its unit, which is converted to the unit of the variable. What is no
 * value, or has another dimension, is reported, and the result is then false.
 */
bool value_read(const char *text, const char *unit, struct Diagnostics *diagnostics, double *value);
