/* The <collision>s and <visual>s of a robot as shapes, and the ground that they stand on. */
#pragma once

#include "read/robots/robot_elements.h"

/* The plane z = 0, and the parameters of contacts with it. */
void write_ground(struct Writer *writer, const struct Robot *robot);

/*
 * The shapes LINK_collision1, ... and LINK_visual1, ... of a link, and where it moves and there is a ground the former's contacts
 * LINK_ground1, ...
 */
void write_shapes(struct Writer *writer, const struct Link *link, bool moves);
