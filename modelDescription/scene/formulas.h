/* Formulas of the positions of joints in terms of parameters, so that drawings follow changed parameters. */
#pragma once

#include "connections.h"

/*
 * Returns a formula for each of the PLACES coordinates of each joint, such as "0.5*l". It is NULL for a coordinate
 * that does not change, or is not linear in the parameters.
 */
char **joint_formulas(const struct Model *model, const struct Connections *connections);
