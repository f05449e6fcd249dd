/* The elements of system.xml, one function each. */
#ifndef ELEMENTS_H
#define ELEMENTS_H

#include "read/context/attributes.h"

/* Reads one element in the pass that it belongs to; does nothing in the others. */
void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass);

/* <solver> and <experiment>, which systems and linearisations have. */
void read_solver(struct Reader *reader, xmlNodePtr node);
void read_experiment(struct Reader *reader, xmlNodePtr node);

/* Name, description and unit; the rest is not there. */
struct Variable common_attributes(struct Reader *reader, xmlNodePtr node);

/* Reports a range or a start value that does not fit. */
void check_range(struct Reader *reader, const struct Variable *variable);

/* Appends a variable, whose strings the list owns from now on. */
struct Variable *append_variable(struct VariableList *list, struct Variable variable);

#endif
