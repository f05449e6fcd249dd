/* Connects a robot's links to the tree that its joints make of them. */
#pragma once

#include <stdbool.h>

#include "base/diagnostics.h"
#include "read/robots/description/robot.h"

/* Sets what struct Link and struct Joint leave to it; false after reporting what is wrong. */
bool robot_connect(struct Robot *robot, struct Diagnostics *diagnostics);

/* The name as one of the language, of letters, digits and _ with no digit first. */
char *robot_symbol(const char *name);

/* The link of this name; NULL after reporting that there is none for what it is asked for. */
struct Link *robot_link(const struct Robot *robot, const char *name, const char *what, struct Diagnostics *diagnostics);

/* Whether the coordinates of the joint, NULL for none, move the link at its end. */
bool joint_moves(const struct Joint *joint);

/* Whether its position is one number: revolute, continuous or prismatic. */
bool joint_is_single(const struct Joint *joint);

/* True if the link that this one is fixed to moves. */
bool carrier_moves(const struct Link *link, bool floats);
