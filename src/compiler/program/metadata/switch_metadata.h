/* Metadata of events, contacts and frictions for struct Lagrangian. */
#pragma once

#include "program/program.h"

/* Returns the table without functions and laws; empty without events. */
struct SwitchTable switch_metadata_of(const struct Program *program);

/* True if frictions follow from contacts or act in planes, so that the runtime needs cone_path (cones.h). */
bool switches_need_cone_path(const struct SwitchTable *switches);
