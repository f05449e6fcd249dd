/* What struct Lagrangian tells of what switches. */
#pragma once

#include "program/program.h"

/* Without the functions and the laws; empty for a system in which nothing switches. */
struct SwitchTable switch_facts_of(const struct Program *program);
