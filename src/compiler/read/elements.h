/* The elements of system.xml, one function each. */
#ifndef ELEMENTS_H
#define ELEMENTS_H

#include "read/attributes.h"

/* Reads one element in the pass that it belongs to; does nothing in the others. */
void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass);

/* The method of this name, as in <solver>; false where there is none. */
bool solver_method(const char *name, enum SolverMethod *method);

/* <solver> and <experiment>, which systems and linearisations have. */
void read_solver(struct Reader *reader, xmlNodePtr node);
void read_experiment(struct Reader *reader, xmlNodePtr node);

#endif
