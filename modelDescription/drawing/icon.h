/* Draws the FMU's icon: dots, lines and outlines. A system without visible objects is a block with arrows. */
#pragma once

#include "picture_shapes.h"
#include "scene/start_scene.h"

/* Returns the drawing, in pixels of a picture of PICTURE_SIZE. */
struct Drawing icon_of(const struct StartScene *scene);

/* Returns the symbol of a mechanical flange, which diagrams show at a terminal. */
struct Drawing flange_icon(void);
