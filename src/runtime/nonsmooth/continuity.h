/*
 * Continuity at switches: a branch that switches must not make positions, velocities or energies jump, since the
 * velocities after such a jump are not determined.
 */
#pragma once

#include "nonsmooth/resolution.h"

/* Projects the state that the solver has left. Returns NULL, or the reason why the motion cannot continue. */
const char *continuity_begin(struct Resolution *resolution);

/* Stores the energies, and the time since the indicator was 0, before a branch switches. */
void continuity_note(struct Resolution *resolution, size_t branch);

/*
 * Checks that branches, and events that set modes or coordinates, leave constraints and energies continuous. Returns
 * NULL, or the reason.
 */
const char *continuity_check(struct Resolution *resolution);

/*
 * Reports Zeno behaviour at the corner of a gap in model exchange. There errors of an integrator move a body that
 * rests in the corner from one piece to the other. Returns NULL, or the reason.
 */
const char *continuity_check_corner(struct Resolution *resolution);

/* Returns the largest change of the state by a smooth branch, in units of the scales: an importer comes to it late. */
double continuity_allowed_share(const struct Resolution *resolution);

/*
 * Logs the contact whose gap has a corner or a jump at a branch: a body that touches both pieces needs a contact for
 * each. False if there is none.
 */
bool continuity_explain_corner(struct Resolution *resolution, size_t branch);

/* Events of one indicator at rest closer than this fraction of the time count as accumulating. */
extern const double close_share;

/* The reasons if the constraints cannot be fulfilled, and if both pieces of a gap are touched. */
extern const char constraints_not_kept[], touched_corner[];
