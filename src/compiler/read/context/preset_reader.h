/* <preset>: named start values of a system, which pages and programs offer to their users. */
#pragma once

#include "read/context/attributes.h"

/* Returns the preset of this name; NULL if there is none. */
const struct Preset *preset_named(const struct Model *model, const char *name);

/*
 * Reads a preset with its values, after all variables are declared. Reports what cannot be set, and values out of
 * range.
 */
void read_preset(struct Reader *reader, xmlNodePtr node);
