/*
 * Forces of a fluid by MuJoCo's inertia model (its chapter on computation, "Fluid forces"). A link counts as the box
 * with its mass and principal moments I, whose sides b are along the principal axes:
 *
 *   b_x^2 = 6 (I_y + I_z - I_x)/m,   and likewise y and z.
 *
 * Its centre of mass has the velocity u relative to the fluid, and its angular velocity is w, both along these axes. The
 * force and torque along x are
 *
 *   -density b_y b_z/2 |u_x| u_x  -  3 pi viscosity d u_x,
 *   -density b_x (b_y^4 + b_z^4)/64 |w_x| w_x  -  pi viscosity d^3 w_x,
 *
 * where d = (b_x + b_y + b_z)/3 is the diameter of a sphere.
 */
#include "robots/robot_fluid.h"

#include <math.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "robots/robot_tree.h"

/* A link in the fluid: the names of its symbol and of the frame along its principal axes, and the sides of its box. */
struct Swimmer {
  const char *name, *frame;
  const struct Fluid *fluid;
  double box[3];
};

void write_wind(const struct Writer *writer, const struct Robot *robot) {
  for (int i = 0; i < 3 && fluid_acts(&robot->fluid); i++)
    if (robot->fluid.wind[i] != 0)
      write_parameter(writer, format_text("wind_%s", axes[i]), robot->fluid.wind[i], "m/s",
                      format_text("velocity of the fluid along %s", axes[i]));
}

/* Writes the frame at the centre of mass, and a point there. Returns the name of both. */
static char *write_frame_of_centre(const struct Writer *writer, const struct RobotLink *link,
                                   const struct Matrix3 *principal) {
  char *name = format_text("%s_fluid", link->symbol);
  struct Placement placement = {.rotation = *principal};
  for (int i = 0; i < 3; i++) placement.translation[i] = link->body.center[i];
  write_placement(writer, write_element(writer, "frame", "name", name, "in", link->symbol, NULL), &placement);
  write_element(writer, "point", "name", format_text("%s_centre", name), "in", name, NULL);
  return name;
}

/* Writes the component of a vector along a principal axis. components: of the vector, along the base's axes. */
static char *write_component(const struct Writer *writer, const struct Swimmer *swimmer, const char *what, int axis,
                             char *const components[3]) {
  char *name = format_text("%s_%s_%s", swimmer->frame, what, axes[axis]);
  set_content(write_element(writer, "define", "name", name, NULL),
              format_text("%s.R1%d*%s + %s.R2%d*%s + %s.R3%d*%s", swimmer->frame, axis + 1, components[0],
                          swimmer->frame, axis + 1, components[1], swimmer->frame, axis + 1, components[2]));
  return name;
}

/*
 * Returns the force or torque along a principal axis against a velocity. drag, viscous: its coefficients, which become
 * parameters.
 */
static char *resistance(const struct Writer *writer, const struct Swimmer *swimmer, bool turns, int axis,
                        const char *velocity, double drag, double viscous) {
  const char *along = turns ? "about" : "along";
  char *sum = copy_text("");
  if (swimmer->fluid->density > 0) {
    char *name = format_text("%s_drag_%s_%s", swimmer->name, along, axes[axis]);
    write_parameter(writer, name, drag, turns ? "kg.m2" : "kg/m",
                    format_text("resistance of the fluid by the square of the velocity %s %s", along, axes[axis]));
    sum = format_text("-%s*abs(%s)*%s", name, velocity, velocity);
  }
  if (swimmer->fluid->viscosity > 0) {
    char *name = format_text("%s_viscous_%s", swimmer->name, turns ? "turning" : "damping");
    if (axis == 0)
      write_parameter(writer, name, viscous, turns ? "N.m.s/rad" : "N.s/m",
                      format_text("resistance of the fluid to %s by the velocity", turns ? "rotation" : "translation"));
    sum = format_text("%s - %s*%s", sum, name, velocity);
  }
  return sum;
}

/* Writes the force, or the torque, with the components of the velocity along the base's axes. */
static void write_resistance(const struct Writer *writer, const struct Swimmer *swimmer, bool turns,
                             char *const velocity[3]) {
  const double *b = swimmer->box;
  double diameter = (b[0] + b[1] + b[2]) / 3, density = swimmer->fluid->density,
         viscous = M_PI * swimmer->fluid->viscosity * (turns ? pow(diameter, 3) : 3 * diameter);
  char *components[3];
  for (int i = 0; i < 3; i++) {
    double one = b[(i + 1) % 3], other = b[(i + 2) % 3];
    double drag = density * (turns ? b[i] * (pow(one, 4) + pow(other, 4)) / 64 : one * other / 2);
    char *name = write_component(writer, swimmer, turns ? "spin" : "flow", i, velocity);
    components[i] = resistance(writer, swimmer, turns, i, name, drag, viscous);
  }
  xmlNodePtr node = write_element(writer, turns ? "torque" : "force", "on", swimmer->frame, "in", swimmer->frame, NULL);
  for (int i = 0; i < 3; i++) set_attribute(node, axes[i], components[i]);
}

void write_fluid_forces(struct Writer *writer, const struct Robot *robot, const struct RobotLink *link) {
  struct Matrix3 principal = link->axes;
  if (!fluid_acts(&robot->fluid) || !(link->body.mass > 0) || !carrier_moves(link, writer->options->floats)) return;
  writer->line = link->line;
  if (!link->has_axes) principal_axes(&link->body.tensor, &principal);
  struct Matrix3 tensor = tensor_along(&link->body, &principal);
  struct Swimmer swimmer = {.name = link->symbol, .fluid = &robot->fluid};
  for (int i = 0; i < 3; i++) {
    double square = tensor.at[(i + 1) % 3][(i + 1) % 3] + tensor.at[(i + 2) % 3][(i + 2) % 3] - tensor.at[i][i];
    swimmer.box[i] = sqrt(6 * fmax(square, 0) / link->body.mass);
  }
  swimmer.frame = write_frame_of_centre(writer, link, &principal);
  char *flow[3], *spin[3];
  for (int i = 0; i < 3; i++) {
    flow[i] = format_text("%s_centre.v%s", swimmer.frame, axes[i]);
    if (robot->fluid.wind[i] != 0) flow[i] = format_text("(%s - wind_%s)", flow[i], axes[i]);
    spin[i] = format_text("%s_body.w%s", link->carrier->symbol, axes[i]);
  }
  write_resistance(writer, &swimmer, false, flow);
  write_resistance(writer, &swimmer, true, spin);
}
