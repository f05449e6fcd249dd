/* The document as a list of the elements that it has without <for> and <include>. */
#pragma once

#include "read/context/attributes.h"

/* Makes the list of what is in the system's own file. Elements are declared on the way: bounds of a <for> may use constants above it. */
void expand(struct Reader *reader, xmlNodePtr root);

/* Reads all elements in a later pass. */
void read_expanded(struct Reader *reader, enum Pass pass);
