/*
 * Start values of coordinates, velocities and states: numbers, or expressions of parameters that are evaluated again
 * when parameters change.
 */
#pragma once

#include "read/context/attributes.h"

/* Read the start expressions of a <coordinate> and of a <state>. */
void read_start_expressions(struct Reader *reader, xmlNodePtr node);
void read_start_of_state(struct Reader *reader, xmlNodePtr node);

/* Evaluates the start expressions at the start values of the parameters. Reports values that are not finite. */
void evaluate_start_expressions(struct Reader *reader);
