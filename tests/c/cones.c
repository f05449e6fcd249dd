/*
 * Solves problems of contacts with Coulomb friction for tests/switching/test_cones.py. The rates u = rate + W p and the
 * impulses p are those of an impact, or accelerations and forces at rest. Each contact has one friction in a plane.
 */
#include <stdlib.h>

#include "evaluation/services.h"
#include "instance/scratch.h"
#include "nonsmooth/cones/cone_impulses.h"
#include "nonsmooth/cones/interior/cone_interior.h"

void *scratch_take(struct Instance *instance, enum ScratchUse use, size_t size) {
  (void)use;
  instance->scratch[0].block = calloc(1, size);
  return instance->scratch[0].block;
}

void scratch_return(struct Instance *instance, enum ScratchUse use) {
  (void)use;
  free(instance->scratch[0].block);
}

bool solver_is_out_of_memory(struct Instance *instance) {
  (void)instance;
  return false;
}

/*
 * Rows are the normals of `contacts` contacts, then two tangents of each. delassus: W by rows; friction: the coefficient
 * of each contact; given: the part of the limit of each row of friction that depends on no contact. Returns 1 if
 * impulse[] fulfils the law by the solver's own measure, else 0.
 */
int solve_cones(size_t contacts, double *delassus, const double *friction, double *given, double *rate, int at_rest,
                double *impulse) {
  size_t frictions = 2 * contacts, count = 3 * contacts;
  static struct Instance instance;
  struct SwitchTable switches = {
      .contact_count = contacts, .friction_count = frictions, .plane_count = contacts, .cone_path = &cone_path};
  struct PlaneMetadata *planes = calloc(contacts, sizeof *planes);
  struct ContactImpulses impulses = {.contact_count = contacts,
                                     .friction_count = frictions,
                                     .count = count,
                                     .member = calloc(count, sizeof(size_t)),
                                     .delassus = delassus,
                                     .rate = rate,
                                     .deciding_count = contacts,
                                     .given = given,
                                     .coefficient = calloc(frictions * contacts, sizeof(double))};
  for (size_t i = 0; i < contacts; i++) {
    planes[i].along = 2 * i;
    impulses.member[i] = i;
    for (size_t j = 2 * i; j < 2 * i + 2; j++) {
      impulses.member[contacts + j] = j;
      impulses.coefficient[j * contacts + i] = friction[i];
    }
  }
  switches.planes = planes;
  struct Resolution resolution = {.instance = &instance, .switches = &switches};
  double error;
  bool is_done = at_rest ? cone_forces_find(&resolution, &impulses, rate, impulse, &error)
                         : cone_impulses_find(&resolution, &impulses, rate, impulse);
  free(planes);
  free(impulses.member);
  free(impulses.coefficient);
  return is_done;
}
