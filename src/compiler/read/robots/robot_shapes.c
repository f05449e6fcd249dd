#include "read/robots/robot_shapes.h"

#include <math.h>

#include "base/memory.h"
#include "model/kinematics.h"
#include "read/robots/description/robot_file.h"

static const char ground[] = "ground";

/* The stiffness lets the robot sink by a millimetre where one point bears all of it. */
static const double sinking = 1e-3, usual_damping = 2.0, usual_friction = 0.8;

static void place_element(xmlNodePtr shape, const struct Placement *place) {
  static const char *const names[] = {"roll", "pitch", "yaw"};
  double angles[3];
  placement_angles(place, angles);
  for (int axis = 0; axis < 3; axis++) {
    set_number(shape, axes[axis], place->translation[axis]);
    set_number(shape, names[axis], angles[axis]);
  }
}

void write_ground(struct Writer *writer, const struct Robot *robot) {
  double mass = 0.0;
  for (size_t i = 0; i < robot->link_count; i++) mass += robot->links[i]->body.mass;
  double stiffness = floor(fmax(mass, 1e-3) * 9.81 / sinking);
  writer->line = robot->line;
  write_parameter(writer, copy_text("ground_stiffness"), stiffness, "N/m",
                  copy_text("force by depth at each point that touches"));
  write_parameter(writer, copy_text("ground_damping"), usual_damping, "s/m",
                  copy_text("by which the force grows with the speed"));
  write_parameter(writer, copy_text("ground_friction"), usual_friction, "1", copy_text("coefficient of friction"));
  xmlNodePtr plane = write_element(writer, "shape");
  set_attribute(plane, "name", copy_text(ground));
  set_attribute(plane, "type", copy_text("plane"));
  if (robot->ground != NULL) place_element(plane, robot->ground);
}

static void write_contact(const struct Writer *writer, const struct Link *link, const char *shape, size_t number) {
  xmlNodePtr contact = write_element(writer, "contact");
  set_attribute(contact, "name", format_text("%s_%s%zu", link->symbol, ground, number));
  set_attribute(contact, "between", copy_text(shape));
  set_attribute(contact, "and", copy_text(ground));
  set_attribute(contact, "stiffness", copy_text("ground_stiffness"));
  set_attribute(contact, "damping", copy_text("ground_damping"));
  set_attribute(contact, "friction", copy_text("ground_friction"));
}

static xmlNodePtr write_shape(struct Writer *writer, const struct Link *link, const struct Collision *collision,
                              char *name) {
  static const char *const sizes[] = {"sizeX", "sizeY", "sizeZ"};
  const double *scale = collision->scale;
  writer->line = collision->line;
  xmlNodePtr shape = write_element(writer, "shape");
  set_attribute(shape, "name", name);
  set_attribute(shape, "in", copy_text(link->symbol));
  set_attribute(shape, "type", copy_text(collision->type));
  place_element(shape, &collision->place);
  for (int axis = 0; axis < 3; axis++) set_number(shape, sizes[axis], collision->size[axis]);
  set_number(shape, "radius", collision->radius);
  set_number(shape, "length", collision->length);
  if (collision->color != NULL) set_attribute(shape, "color", copy_text(collision->color));
  if (collision->file == NULL) return shape;
  char *x = number(scale[0]), *y = number(scale[1]), *z = number(scale[2]);
  set_attribute(shape, "file", copy_text(collision->file));
  set_attribute(shape, "scale", format_text("%s %s %s", x, y, z));
  return shape;
}

void write_shapes(struct Writer *writer, const struct Link *link, bool moves) {
  for (size_t i = 0; i < link->collision_count; i++) {
    char *name = format_text("%s_collision%zu", link->symbol, i + 1);
    xmlNodePtr shape = write_shape(writer, link, &link->collisions[i], name);
    if (link->visual_count > 0) set_attribute(shape, "drawn", copy_text("false"));
    if (moves && link_touches_ground(writer->options, link->name)) write_contact(writer, link, name, i + 1);
  }
  for (size_t i = 0; i < link->visual_count; i++)
    write_shape(writer, link, &link->visuals[i], format_text("%s_visual%zu", link->symbol, i + 1));
}
