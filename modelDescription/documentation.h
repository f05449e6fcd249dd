/* Writes documentation/index.html: the Lagrangian, the derived equations and the variables, of large systems in part. */
#ifndef DOCUMENTATION_H
#define DOCUMENTATION_H

#include <libxml/tree.h>

#include "mechanics/interface.h"
#include "mechanics/summary.h"

bool documentation_write(xmlBufferPtr buffer, const struct Model *model, const struct Equations *equations,
                         const struct Interface *interface, const struct Summary *summary);

#endif
