/* Writes documentation/index.html: Lagrangian, equations and variables, abridged for large systems. */
#ifndef DOCUMENTATION_H
#define DOCUMENTATION_H

#include <libxml/tree.h>

#include "interface/summary.h"
#include "program/program.h"
#include "scene/start_scene.h"

bool documentation_write(xmlBufferPtr buffer, const struct Program *program, const struct Summary *summary,
                         const struct StartScene *scene);

#endif
