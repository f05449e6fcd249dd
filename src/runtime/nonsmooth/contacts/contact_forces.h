/* Existence and uniqueness of the forces of contacts at rest, with the frictions that slide on them. */
#pragma once

#include "nonsmooth/resolution.h"

/*
 * Opens and closes contacts at rest according to the solution for their forces; sets *again if any changed. Warns once
 * if the solution was not shown to be the only one. Returns NULL, or, after logging contact and friction, the reason
 * why the motion cannot continue.
 */
const char *contact_forces_resolve(struct Resolution *resolution, bool *again);

/*
 * Logs a contact that closes whatever its impulse, and one that opposes it: prescribed motions crush a body between
 * them. Returns the reason why the motion cannot continue.
 */
const char *contact_forces_report_crushed(struct Resolution *resolution, size_t contact);

/* Logs a contact that closes although no force changes its gap. */
void contact_forces_report_fixed(const struct Resolution *resolution, size_t contact);

/* Logs a sliding contact that friction jams at the end of the motion; false if there is none. */
bool contact_forces_explain(struct Resolution *resolution);
