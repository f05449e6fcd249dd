/* Contact points of pairs of shapes: which function finds them, and in which order it takes the shapes. */
#include "read/shapes/contact_points.h"

#include "algebra/simplify.h"
#include "base/memory.h"
#include "read/shapes/box_points.h"
#include "read/shapes/nearest_points.h"
#include "read/shapes/plane_points.h"
#include "read/shapes/reach.h"

struct ContactSide contact_side_of(struct Reader *reader, long line, const struct ContactShape *shape) {
  const struct Mechanism *mechanism = &reader->model->mechanism;
  const char *name = shape->name;
  struct Pose pose = mechanism->frames[shape->frame].pose;
  if (shape->particle != NO_PARTICLE) {
    pose = pose_of_base();
    for (int i = 0; i < 3; i++) pose.origin.along[i] = mechanism->bodies[shape->particle].displaced[i];
    for (int i = 0; i < 3; i++) pose.velocity.along[i] = total_time_derivative(reader->scope, pose.origin.along[i]);
  }
  pose.rotation = matrix_without_displacements(reader, line, name, pose.rotation);
  pose.origin = vector_without_displacements(reader, line, name, pose.origin);
  pose.velocity = vector_without_displacements(reader, line, name, pose.velocity);
  pose.angular_velocity = vector_without_displacements(reader, line, name, pose.angular_velocity);
  return (struct ContactSide){shape, pose};
}

typedef void ContactFunction(const struct ShapePair *pair, struct ContactPoints *contacts);

/* By types of the first and second shape. Pairs in the other order are exchanged. */
static ContactFunction *const functions[SHAPE_TYPES][SHAPE_TYPES] = {
    [SHAPE_SPHERE] = {plane_contacts, sphere_contact, box_contact, cylinder_contact, capsule_contact},
    [SHAPE_BOX] = {plane_contacts, [SHAPE_BOX] = boxes_contacts},
    [SHAPE_CYLINDER] = {rim_contacts},
    [SHAPE_CAPSULE] = {plane_contacts, [SHAPE_BOX] = capsule_on_box_contacts, [SHAPE_CAPSULE] = capsules_contact},
    [SHAPE_MESH] = {plane_contacts},
    [SHAPE_ELLIPSOID] = {ellipsoid_contact},
};

/* Returns the number of points of two shapes in the order of functions[]; 0 if there is no function. */
static size_t count_points(const struct ContactShape *first, const struct ContactShape *second) {
  ContactFunction *append_contacts = functions[first->type][second->type];
  if (append_contacts == NULL) return 0;
  if (append_contacts == capsule_on_box_contacts) return count_points_of_capsule_on_box(second);
  if (append_contacts == boxes_contacts) return POINTS_OF_BOXES;
  return second->type == SHAPE_PLANE ? count_points_on_plane(first) : 1;
}

size_t count_contact_points(const struct ContactShape *first, const struct ContactShape *second) {
  size_t count = count_points(first, second);
  return count > 0 ? count : count_points(second, first);
}

struct ContactPoints contact_points_of(struct Reader *reader, long line, const struct ContactSide *first,
                                       const struct ContactSide *second, bool is_rigid) {
  struct Graph *graph = reader->model->graph;
  ContactFunction *append_contacts = functions[first->shape->type][second->shape->type];
  bool is_exchanged = append_contacts == NULL;
  struct ShapePair pair = {reader->scope, graph, line, is_exchanged ? second : first, is_exchanged ? first : second,
                           is_rigid};
  if (is_exchanged) append_contacts = functions[second->shape->type][first->shape->type];
  struct ContactPoints contacts = {
      .items = allocate(count_contact_points(first->shape, second->shape), sizeof *contacts.items)};
  /* Boxes on boxes have conditions of their own. */
  contacts.are_near = append_contacts == boxes_contacts ? ONE : are_near(&pair);
  append_condition(&reader->model->switches, contacts.are_near);
  reader->scope->relevance = contacts.are_near;
  append_contacts(&pair, &contacts);
  reader->scope->relevance = ONE;
  for (size_t i = 0; i < contacts.count && is_exchanged; i++)
    contacts.items[i].normal = vector_scale(graph, graph_constant(graph, -1.0), contacts.items[i].normal);
  return contacts;
}
