/* <linearization>: a system and the point at which it is linearized. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "model/model.h"
#include "names/scope.h"

/* Returns the path of the system that root linearizes, relative to the file of root; NULL if root names none. */
char *linearized_path(xmlNodePtr root, const char *path);

/* Turns the model of that system into its linearization, with the name, point and solver in root. */
void read_linearization(struct Model *model, struct Scope *scope, xmlNodePtr root, struct Diagnostics *diagnostics);

/* Sets the point from texts "name=value" and marks the model as linearized. */
void apply_point(struct Model *model, struct Scope *scope, const char *const *point, size_t count,
                 struct Diagnostics *diagnostics);
