/* Expands <for> and <include>: turns the document into a list of elements, on which all passes work. */
#pragma once

#include "read/context/attributes.h"

/*
 * Appends the elements of a <system> to the list and declares each one. The order matters: bounds of a <for> may use
 * constants declared before it.
 */
void expand(struct Reader *reader, xmlNodePtr root);

/* Reads all elements of the list in a later pass. */
void read_expanded(struct Reader *reader, enum Pass pass);
