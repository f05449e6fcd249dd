/*
 * What a page needs to let bodies be pulled with a pointer: inputs for the place of the pointer and for the point of the body that it
 * holds, and a force towards it at each body.
 */
#pragma once

#include "read/context/attributes.h"

/* Adds the inputs pull.x, ... and pull.of.BODY, and the forces. Of very many bodies some are left out. */
void add_pulls(struct Reader *reader);
