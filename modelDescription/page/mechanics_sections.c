#include "mechanics_sections.h"

#include "mechanics/energies.h"

/* Returns the balance of energy that totalEnergy obeys, see energies.h. */
static const char *balance_of(const struct Model *model, bool autonomous) {
  if (work_is_of_everything(model))
    return "totalEnergy changes by nonConservativeWork alone, which includes the work of what moves states and "
           "constraints: its derivative is P.";
  if (model->given.constraint != NULL)
    return "A constraint depends on time or inputs: its force does work, so that totalEnergy is not constant even "
           "without other forces.";
  if (!model->energies.driven && autonomous)
    return model->forces.any
               ? "totalEnergy changes by the work of the non-conservative forces alone: its derivative is P."
               : "totalEnergy is constant.";
  if (!model->energies.driven)
    return "L depends on time explicitly: the derivative of totalEnergy is the power of the non-conservative forces "
           "less the partial derivative dL/dt, so that totalEnergy is not constant even without forces.";
  if (autonomous)
    return "Masses have prescribed motions: totalEnergy is their energy K + U. The prescribed motions do work, so that "
           "totalEnergy is not constant even without forces. Jacobi's integral, the sum of v dL/dv less L, is another "
           "quantity here: its derivative is the sum of the generalized forces times the velocities v, so that it is "
           "constant without forces.";
  return "Masses have prescribed motions: totalEnergy is their energy K + U. The prescribed motions do work, so that "
         "totalEnergy is not constant even without forces. Jacobi's integral, the sum of v dL/dv less L, is another "
         "quantity here: its derivative is the sum of the generalized forces times the velocities v, less the partial "
         "derivative dL/dt, so that it is not constant either.";
}

static void write_energies(struct Page *page) {
  const struct Summary *summary = page->summary;
  bool linearized = page->model->linearized;
  bool separate = !linearized && page->model->energies.kinetic.node != page->equations->kinetic;
  page_heading(page, "Energies");
  if (separate) page_equation(page, "T", summary->lagrangian_kinetic);
  page_equation(page, "K", summary->kinetic);
  page_equation(page, "U", summary->potential);
  page_element(page, "p", separate ? "The Lagrangian is L = T - U." : "The Lagrangian is L = K - U.");
  if (linearized) return;
  page_element(
      page, "p",
      "kineticEnergy is K: half of mass times squared velocity of every body, and for each <kinetic> term T the "
      "term itself where it is a quadratic polynomial of the velocities v, else the sum of v dT/dv less T. "
      "potentialEnergy is U less the sum of v dU/dv, which is U where it has no velocities. totalEnergy is the "
      "sum of both.");
  page_element(page, "p", balance_of(page->model, summary->is_autonomous));
  if (page->model->switches.contact_count + page->model->switches.event_count > 0)
    page_element(page, "p",
                 "This holds between events: impacts, and values that events set, may change totalEnergy at once.");
}

static void write_constraints(struct Page *page) {
  const struct VariableList *constraints = &page->model->constraints;
  size_t shown = constraints->count < SHOWN_LIMIT ? constraints->count : SHOWN_LIMIT;
  if (shown == 0) return;
  page_heading(page, "Constraints");
  for (size_t i = 0; i < shown; i++) page_equation(page, constraints->items[i].name, constraints->items[i].node);
  page_rest(page, constraints->count, shown, "constraints");
  page_element(
      page, "p",
      "Each is 0 at all times. Its force F stands on the left of the equations of motion, times the derivatives of the "
      "constraint by the coordinates, or by the velocities if it has any: it is a tension where the constraint is a "
      "distance less a length. After each step of the solver the state is projected onto the constraints.");
}

static void write_reactions(struct Page *page) {
  const struct VariableList *reactions = &page->model->reactions;
  if (reactions->count == 0) return;
  page_heading(page, "Forces of reaction");
  for (size_t i = 0; i < page->summary->reaction_count; i++)
    page_equation(page, reactions->items[i].name, page->summary->reactions[i]);
  page_rest(page, reactions->count, page->summary->reaction_count, "forces");
  page_element(page, "p",
               "The force along a displacement is that of the system against the support that keeps the displacement "
               "at 0, from Lagrange's equation of the displacement: the tension of a rod that it makes longer. The "
               "force of a prescribed motion is that on its coordinate, from Lagrange's equation of the coordinate.");
}

void write_mechanics(struct Page *page) {
  const struct Summary *summary = page->summary;
  write_energies(page);
  write_constraints(page);
  page_heading(page, "Equations of motion");
  for (size_t i = 0; i < summary->motion_count; i++) {
    char *left = expression_text_with_names(page->model->graph, summary->inertial[i], &summary->names);
    page_equation(page, left, summary->right_side[i]);
  }
  page_rest(page, page->equations->count, summary->motion_count, "equations");
  write_reactions(page);
  if (!page->model->forces.any) return;
  page_heading(page, "Power of the non-conservative forces");
  page_equation(page, "P", summary->power);
  if (work_is_of_everything(page->model)) return;
  page_element(page, "p",
               "It is the sum of force times velocity over the generalized forces and the dissipation, and of F . "
               "dr/dt over the Cartesian forces, where dr/dt is the whole velocity of the point they act on. The "
               "forces of prescribed motions count too, also of points that depend on inputs.");
}
