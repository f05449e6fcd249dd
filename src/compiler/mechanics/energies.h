/*
 * Energies of the terms of the Lagrangian. A term X of L contributes sum v dX/dv - X to Jacobi's integral, which is
 * constant if L does not depend on time (H. Goldstein: Classical Mechanics, chapter 2). The kinetic energy of masses
 * with prescribed motion differs from that.
 */
#pragma once

#include "model/model.h"

/*
 * True if <work/> has all work that changes the energy, not only that of forces and prescribed motions. This is so
 * if states or constraints move masses, whose work follows from the energy, W' = d(T + U)/dt.
 */
bool work_includes_all_forces(const struct Model *model);

/* Returns U - sum v dU/dv, the energy stored by a potential. Terms linear in the velocities store none. */
Node stored_energy(const struct Model *model, Node potential);

/*
 * Returns the energy of a <kinetic> term T. A quadratic polynomial of the velocities is the energy of masses as it is,
 * even with prescribed velocities as in T = J (v + W)^2 / 2; *is_prescribed is true then. Any other T, such as that of a
 * relativistic particle, gives sum v dT/dv - T.
 */
Node energy_of_kinetic_term(const struct Model *model, Node term, bool *is_prescribed);
