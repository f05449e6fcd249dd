/* The elements of system.xml: the functions that read each of them. */
#pragma once

#include "read/context/attributes.h"

/* Reads an element in this pass, if the pass has a function for it. */
void read_element(struct Reader *reader, xmlNodePtr node, enum Pass pass);

/* Read <solver> and <experiment>, which systems and linearizations have. */
void read_solver(struct Reader *reader, xmlNodePtr node);
void read_experiment(struct Reader *reader, xmlNodePtr node);
