/* Search for impulses of contacts and frictions by sweeps, Newton's method and an interior path. */
#pragma once

#include "nonsmooth/cones/cones.h"

/*
 * The largest relative residual that is accepted. Rounding leaves up to 1e-9 where sticking frictions are at their
 * limits or impulses are small beside rates.
 */
static const double law_roughly_holds = 1e-5;

/* Impulses of a sweep change at once, or in turn, each with the rates by the impulses before it. */
enum Sweeps { AT_ONCE, IN_TURN };

/* Divides a block among scale, best, swept and work for n rows. Returns its number of doubles. */
size_t cones_lay_out(struct Cones *cones, size_t n, double *block);

/* Fills the scales. False if a contact cannot be moved. */
bool cones_fill_scales(struct Cones *cones);

/*
 * Makes trials, each with sweeps from where the sweeps before ended (the first with none, at cones->swept), then
 * Newton's method. Leaves the best impulses in cones->impulse, and returns their relative residual.
 */
double cones_search_from(struct Cones *cones, enum Sweeps kind, int trials);

/*
 * Finds impulses by sweeps from cones->swept; by an interior path if these do not converge. False if none are found, or
 * a contact cannot be moved.
 */
bool cones_find_impulses(struct Cones *cones);

/*
 * Finds forces by an interior path, in the middle of those that are possible; else by sweeps from no force. Returns
 * their relative residual; INFINITY if a contact cannot be moved.
 */
double cones_find_forces(struct Cones *cones);

/*
 * Finds forces of n contacts without rows of friction. delassus: n x n, may be nonsymmetric, as where frictions slide;
 * rate: accelerations without the forces. False, with an approximation in force[], if none are found.
 */
bool pressing_forces_find(const struct ConePath *path, size_t n, double *delassus, const double *rate, double *force,
                          double *work);

/* Returns the number of doubles of its workspace. */
size_t pressing_forces_work_count(const struct ConePath *path, size_t n);
