/* <constraint>: what is 0 at all times. */
#pragma once

#include "read/context/attributes.h"

/* Declares the constraint of an element; its name alone is no value, but that of its force is. */
void declare_constraint(struct Reader *reader, xmlNodePtr node);

/* Reads the expression of the next constraint; they come in the order in which they were declared. */
void read_constraint(struct Reader *reader, xmlNodePtr node);
