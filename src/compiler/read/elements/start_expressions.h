/*
 * Start values of coordinates, velocities, states and modes: numbers, or expressions of parameters that are evaluated
 * again when parameters change.
 */
#pragma once

#include "read/context/attributes.h"

/* Returns a start value that is a plain number, else 0, for integrals, which precede the start expressions. */
double preliminary_start(xmlNodePtr node, const char *name);

/* Read the start expressions of a <coordinate>, a <state> and a <mode>. */
void read_start_expressions(struct Reader *reader, xmlNodePtr node);
void read_start_of_state(struct Reader *reader, xmlNodePtr node);
void read_start_of_mode(struct Reader *reader, xmlNodePtr node);

/* Evaluates the start expressions at the start values of the parameters. Reports values that are not finite. */
void evaluate_start_expressions(struct Reader *reader);
