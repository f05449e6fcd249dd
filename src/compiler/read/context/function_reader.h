/* <function>. */
#pragma once

#include "read/context/attributes.h"

/* Makes the function known; its expression is read where it is called. */
void declare_function(struct Reader *reader, xmlNodePtr node);
