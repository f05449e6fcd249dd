/* The elements of system.xml, one function each. */
#pragma once

#include "read/context/attributes.h"

/* Reads one element in the pass that it belongs to; does nothing in the others. */
void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass);

/* <solver> and <experiment>, which systems and linearisations have. */
void read_solver(struct Reader *reader, xmlNodePtr node);
void read_experiment(struct Reader *reader, xmlNodePtr node);
