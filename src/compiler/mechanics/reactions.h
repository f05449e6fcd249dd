/*
 * Reaction forces along a prescribed motion s, such as a virtual displacement that is always 0, by the equation of this
 * motion alone. With positions r, and with L for <kinetic> less the potential,
 *
 *  R = sum m (d2r/dt2) . dr/ds + d/dt (dL/ds') - dL/ds - Q_s
 *
 * at the true motion of the system.
 */
#pragma once

#include "model/model.h"

/*
 * Derives the forces along the displacements, the first of model->reactions; they may contain acceleration symbols. The
 * sign is -R: a displacement that lengthens a rod gives its tension.
 */
void reactions_derive(const struct Model *model, Node *reactions);

/* Returns the power of the inputs that move positions; it may contain acceleration symbols. */
Node power_of_moving_points(const struct Model *model);

/* Returns replacements for all symbols: 0 for displacements, other symbols for themselves. */
Node *undisplaced_symbols(const struct Graph *graph);

/* Replaces the symbols of reactions in a node by these expressions. */
Node with_reactions(const struct Model *model, const Node *reactions, Node node);
