#pragma once

#include "read/context/attributes.h"

/* Declares the constraint of a <constraint>. Its name has no value of its own; that of its force has one. */
void declare_constraint(struct Reader *reader, xmlNodePtr node);

/* Reads the expression of a <constraint> and checks it. */
void read_constraint(struct Reader *reader, xmlNodePtr node);
