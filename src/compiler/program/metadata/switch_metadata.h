/* Metadata of events, contacts and frictions for struct Lagrangian. */
#pragma once

#include "program/program.h"

/* Returns the table without functions and laws; empty without events. */
struct SwitchTable switch_metadata_of(const struct Program *program);
