/*
 * What of the Lagrangian's terms is energy. A term X of L contributes Jacobi's sum v dX/dv - X, which is constant
 * where nothing depends on time; the kinetic energy of masses that are moved in a given way is another one.
 */
#pragma once

#include "model/model.h"

/* U - sum v dU/dv: what a potential stores. Terms linear in the velocities (magnetic forces) store nothing. */
Node stored_energy(const struct Model *model, Node potential);

/*
 * The energy of a <kinetic> term T. A quadratic polynomial of the velocities is the energy of masses as it stands, as
 * for bodies, also where they have velocities without the coordinates' (T = J (v + W)^2 / 2); *driven says whether
 * that is so. Any other T contributes sum v dT/dv - T, as for a relativistic particle.
 */
Node energy_of_kinetic_term(const struct Model *model, Node term, bool *driven);
