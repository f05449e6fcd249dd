/* How the places of joints follow from parameters, so that they can be drawn where parameters are others. */
#pragma once

#include "links.h"

/*
 * A formula of parameters for each place of each joint, PLACES a joint, such as "0.5*l"; NULL for a place that stays as it is, or
 * is no sum of multiples of parameters.
 */
char **joint_formulas(const struct Model *model, const struct Links *links);
