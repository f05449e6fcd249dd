/* <parameter>: numbers of each type of FMI, lists of them, and those that are calculated. */
#pragma once

#include "read/context/includes.h"

/* Reports an index in the name of a list. */
void check_name_of_list(struct Reader *reader, xmlNodePtr node, const char *name);

/* Declares a parameter that can be set, or one for each of its values; calculated ones are definitions. */
void read_parameter(struct Reader *reader, xmlNodePtr node);

/* Reports what cannot stand beside a value, the element's own or a given one. */
void check_calculated(struct Reader *reader, const struct Given *given, xmlNodePtr node);
