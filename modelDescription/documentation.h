/* Writes documentation/index.html: the Lagrangian, the derived equations and the variables. */
#ifndef DOCUMENTATION_H
#define DOCUMENTATION_H

#include <libxml/tree.h>

#include "program/program.h"

bool documentation_write(xmlBufferPtr buffer, const struct Program *program);

#endif
