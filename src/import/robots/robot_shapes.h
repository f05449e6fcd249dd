/* Converts <collision>s and <visual>s of a robot to shapes, and writes contacts with the ground and among them. */
#pragma once

#include "base/diagnostics.h"
#include "robots/robot_elements.h"

/* Writes the plane z = 0, or that of the file, and the parameters of contacts with it. */
void write_ground(struct Writer *writer, const struct Robot *robot);

/*
 * Writes the shapes LINK_collision1, ... and LINK_visual1, ... of a link. If the link moves and there is a ground, also
 * writes the contacts LINK_ground1, ... of the former.
 */
void write_shapes(struct Writer *writer, const struct RobotLink *link, bool moves);

/* True if the shape touches the ground, provided that its link moves. */
bool meets_ground(const struct RobotOptions *options, const struct RobotLink *link, const struct Collision *shape);

/*
 * Finds the pairs of shapes of a URDF: of links that move relative to each other, and are not parent and child. Warns
 * of pairs of types that cannot touch.
 */
void find_pairs(struct Robot *robot, const struct RobotOptions *options, const struct Diagnostics *diagnostics);

/* Writes the contacts of all pairs, with their parameters. The shapes are written before. */
void write_pairs(struct Writer *writer, const struct Robot *robot);
