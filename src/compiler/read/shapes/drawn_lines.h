/* <line>: reads lines that are drawn without mechanics, see drawn_line.h. */
#pragma once

#include "read/context/attributes.h"

/* Reads a <line> in the pass DRAWING. */
void read_line(struct Reader *reader, xmlNodePtr node);

/* Draws a <spring> as a coil, in systems without a <line>. */
void draw_spring(struct Reader *reader, xmlNodePtr node);

/* Begins and ends the pass DRAWING, whose expressions become nodes of a graph of their own. */
struct Scope *begin_drawing(struct Reader *reader);
void end_drawing(struct Reader *reader, struct Scope *scope);

/* True if the system has an element that is read in the pass DRAWING: a <line>, <spring> or <task>. */
bool has_drawing(const struct Reader *reader);
