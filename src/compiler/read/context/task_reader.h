/* <task>: an exercise on the live page, with goals that users reach by the inputs. */
#pragma once

#include "read/context/attributes.h"

/*
 * Reads a task with its goals, in the pass DRAWING, after all presets. Reports goals without limits and unknown
 * presets.
 */
void read_task(struct Reader *reader, xmlNodePtr node);
