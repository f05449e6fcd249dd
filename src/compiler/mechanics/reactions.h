/*
 * Forces of reaction: what must act along a motion that is given, such as a virtual displacement s that is always 0, from
 * the equation of this motion alone, with r for the positions and L for <kinetic> less the potential,
 *
 *   R = sum m (d2r/dt2) . dr/ds + d/dt (dL/ds') - dL/ds - Q_s
 *
 * along the true motion of all else.
 */
#pragma once

#include "model/model.h"

/*
 * The forces along the displacements, the first of model->reactions, with the acceleration symbols: -R, what the system
 * pushes with, as the tension of a rod for a displacement that makes it longer.
 */
void reactions_derive(const struct Model *model, Node *reactions);

/* The power of what moves the inputs on which positions and energies depend, with the acceleration symbols. */
Node moving_power(const struct Model *model);

/* What replaces each symbol where nothing is displaced: itself, or 0 for a displacement. */
Node *undisplaced_symbols(const struct Graph *graph);

/* The node with the symbols of reactions replaced by these. */
Node with_reactions(const struct Model *model, const Node *reactions, Node node);
