#include "mechanics_sections.h"

#include "base/memory.h"
#include "mechanics/energies.h"

/* Returns the balance of energy that totalEnergy obeys, see energies.h. */
static const char *balance_of(const struct Model *model, bool autonomous) {
  if (work_includes_all_forces(model))
    return "totalEnergy changes by nonConservativeWork alone, which includes the work of what moves states and "
           "constraints: its derivative is P.";
  if (model->prescribed.constraint != NULL)
    return "A constraint prescribes a motion: its force does work, so that totalEnergy is not constant even without "
           "other forces.";
  if (!model->energies.has_prescribed && autonomous)
    return model->forces.any
               ? "totalEnergy changes by the work of the non-conservative forces alone: its derivative is P."
               : "totalEnergy is constant.";
  if (!model->energies.has_prescribed)
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

/* Writes the parts of the energies that the system has. */
static void write_meaning_of_energies(struct Page *page) {
  const struct Model *model = page->model;
  const char *of_bodies = model->mechanism.body_count > 0 ? " half of mass times squared velocity of every body" : "";
  const char *of_terms =
      model->energies.explicit_kinetic.node != ZERO
          ? " for each <kinetic> term T the term itself where it is a quadratic polynomial of the velocities v, else "
            "the sum of v dT/dv less T"
          : "";
  const char *less =
      graph_depends_on(model->graph, model->energies.potential.node, VELOCITY) ? "U less the sum of v dU/dv" : "U";
  page_paragraph(page, format_text("kineticEnergy is K:%s%s%s. potentialEnergy is %s. totalEnergy is the sum of both.",
                                   of_bodies, *of_bodies != '\0' && *of_terms != '\0' ? ", and" : "", of_terms, less));
}

static void write_energies(struct Page *page) {
  const struct Summary *summary = page->summary;
  bool linearized = page->model->linearized;
  bool separate = !linearized && page->model->energies.kinetic.node != page->equations->kinetic;
  bool has_symbol = *page_symbol(page->model, "L", "") != '\0';
  page_heading(page, "Energies");
  if (separate) page_equation(page, "T", summary->lagrangian_kinetic);
  page_equation(page, "K", summary->kinetic);
  page_equation(page, "U", summary->potential);
  page_paragraph(page, format_text("The Lagrangian is %s%s - U.", has_symbol ? "L = " : "", separate ? "T" : "K"));
  if (linearized) return;
  write_meaning_of_energies(page);
  page_paragraph(page, balance_of(page->model, summary->is_autonomous));
  if (page->model->switches.contact_count + page->model->switches.event_count > 0)
    page_paragraph(page,
                   "This holds between events: impacts, and values that events set, may change totalEnergy at once.");
}

/* Returns the name of a constraint, and when it holds. */
static char *constraint_label(const struct Model *model, size_t i) {
  const struct Switches *switches = &model->switches;
  const char *name = model->constraints.items[i].name;
  for (size_t k = 0; k < switches->contact_count; k++)
    if (switches->contacts[k].constraint == i)
      return format_text("%s: the gap, positive unless %s is 1", name,
                         graph_symbol_of(model->graph, switches->contacts[k].mode)->name);
  for (size_t k = 0; k < switches->friction_count; k++)
    if (switches->frictions[k].constraint == i) return format_text("%s, while it sticks", name);
  return copy_text(name);
}

static void write_constraints(struct Page *page) {
  const struct Model *model = page->model;
  const struct Summary *summary = page->summary;
  size_t count = model->constraints.count;
  if (count == 0) return;
  page_heading(page, "Constraints");
  for (size_t i = 0; i < summary->constraint_count; i++)
    page_labelled_equation(page, constraint_label(model, i), summary->constraints[i], ZERO);
  page_rest(page, count, summary->constraint_count, "constraints");
  if (count > model->switches.contact_count + model->switches.friction_count)
    page_paragraph(
        page, "A constraint's force λ, its multiplier, stands on the left of the equations of motion, times the "
              "derivatives of the constraint by the coordinates, or by the velocities if it has any: it is a tension "
              "where the constraint is a distance less a length. After each step of the solver the state is projected "
              "onto the constraints.");
  if (model->switches.contact_count > 0)
    page_paragraph(page, "The force λ of a closed contact pushes; that of an open one is 0.");
}

static void write_reactions(struct Page *page) {
  const struct VariableList *reactions = &page->model->reactions;
  if (reactions->count == 0) return;
  page_heading(page, "Forces of reaction");
  for (size_t i = 0; i < page->summary->reaction_count; i++)
    page_equation(page, reactions->items[i].name, page->summary->reactions[i]);
  page_rest(page, reactions->count, page->summary->reaction_count, "forces");
  if (page->model->displacements.count > 0)
    page_paragraph(
        page, "The force along a displacement is that of the system against the support that keeps the displacement "
              "at 0, from Lagrange's equation of the displacement: the tension of a rod that it makes longer.");
  if (page->model->prescribed.motion_count > 0)
    page_paragraph(page, "The force of a prescribed motion is that on its coordinate, from Lagrange's equation of the "
                         "coordinate.");
}

void write_mechanics(struct Page *page) {
  const struct Summary *summary = page->summary;
  write_energies(page);
  write_constraints(page);
  page_heading(page, "Equations of motion");
  for (size_t i = 0; i < summary->motion_count; i++)
    page_labelled_equation(page, page->model->coordinates.items[i].name, summary->inertial[i], summary->right_side[i]);
  page_rest(page, page->equations->count, summary->motion_count, "equations");
  write_reactions(page);
  if (!page->model->forces.any) return;
  page_heading(page, "Power of the non-conservative forces");
  page_equation(page, "P", summary->power);
  if (work_includes_all_forces(page->model)) return;
  if (page->model->forces.point_count > 0 || page->model->prescribed.motion_count > 0)
    page_paragraph(page,
                   "It is the sum of force times velocity over the generalized forces and the dissipation, and of F . "
                   "dr/dt over the Cartesian forces, where dr/dt is the whole velocity of the point they act on. The "
                   "forces of prescribed motions count too, also of points that depend on inputs.");
}
