#pragma once

#include "read/context/attributes.h"

/* Defines the function of a <function>. Its expression is parsed at each call. */
void declare_function(struct Reader *reader, xmlNodePtr node);
