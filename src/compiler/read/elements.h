/* The elements of system.xml, one function each. */
#ifndef ELEMENTS_H
#define ELEMENTS_H

#include "read/attributes.h"

/* Reads one element in the pass that it belongs to; does nothing in the others. */
void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass);

/* <solver> and <experiment>, which systems and linearisations have. */
void read_solver(struct Reader *reader, xmlNodePtr node);
void read_experiment(struct Reader *reader, xmlNodePtr node);

/* The value of a <define>, or of a component of a particle or body or a <parameter>, for NULL or the attribute's name. */
struct Quantity read_named_expression(struct Reader *reader, xmlNodePtr node, const char *attribute);

/* Enters the value of a <define> or a <parameter> into the model, under its name; bodies enter their components. */
void keep_named_expression(struct Reader *reader, xmlNodePtr node, const char *name, struct Quantity value);

/* Appends a variable, whose strings the list owns from now on. */
struct Variable *append_variable(struct VariableList *list, struct Variable variable);

#endif
