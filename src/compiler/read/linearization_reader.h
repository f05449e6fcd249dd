/* <linearization>: another system and the point at which it is linearised. */
#pragma once

#include <libxml/tree.h>

#include "base/diagnostics.h"
#include "model/model.h"
#include "read/names/scope.h"

/* The path of the system that root linearises, relative to the file that holds it. */
char *linearized_path(xmlNodePtr root, const char *path);

/* Turns the model that was read from there into the linearised one of this name. */
void read_linearization(struct Model *model, struct Scope *scope, xmlNodePtr root, struct Diagnostics *diagnostics);

/* Sets the point from "name=value" texts and marks the model as linearised. */
void apply_point(struct Model *model, struct Scope *scope, const char *const *point, size_t count,
                 struct Diagnostics *diagnostics);
