/* Contacts between shapes of one robot. */
#pragma once

#include "base/diagnostics.h"
#include "robots/robot_elements.h"

/*
 * Finds the pairs of shapes of a URDF: of links that move relative to each other, and are not parent and child. Warns
 * of pairs of types that cannot touch.
 */
void find_pairs(struct Robot *robot, const struct RobotOptions *options, const struct Diagnostics *diagnostics);

/* Writes the contacts of all pairs, with their parameters. The shapes are written before. */
void write_pairs(struct Writer *writer, const struct Robot *robot);
