/* Values of variables that are given outside of systems, such as "30deg", "pi/2" or "0.5". */
#pragma once

#include <stdbool.h>

#include "base/diagnostics.h"

/*
 * Reads a value: an expression of numbers, or a number and its unit, which is converted to the unit of the variable.
 * Returns false after reporting a text that is not a value, or has another dimension.
 */
bool value_read(const char *text, const char *unit, struct Diagnostics *diagnostics, double *value);

/* Sets the value of an expression of numbers, without messages. False for others, as with names of parameters. */
bool value_of_numbers(const char *text, double *value);

/* True if the text is a number followed by a unit. */
bool value_has_unit(const char *text);

/* Does the same as value_read() with the value of an option, such as "-D L"; messages begin with the option. */
bool value_of_option(const char *option, const char *text, const char *unit, struct Diagnostics *diagnostics,
                     double *value);
