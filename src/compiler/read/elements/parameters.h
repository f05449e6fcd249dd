/* <parameter>: single values of each FMI type, lists of values, and calculated parameters. */
#pragma once

#include "read/context/includes.h"

/* Reports a list whose name has an index. */
void check_name_of_list(struct Reader *reader, xmlNodePtr node, const char *name);

/* Declares a parameter, or one per value of a list. Calculated parameters are collected as definitions instead. */
void read_parameter(struct Reader *reader, xmlNodePtr node);

/* Reports attributes that cannot be combined with a value, in the element or an override. */
void check_calculated(struct Reader *reader, const struct Override *overrides, xmlNodePtr node);
