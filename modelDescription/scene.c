#include "scene.h"

#include "algebra/formula.h"
#include "xml_output.h"

enum { BASE = 0 }; /* among the model's frames */

static void write_formula(xmlTextWriterPtr writer, const struct Graph *graph, const char *name, Node node) {
  if (node == ZERO) return;
  write_attribute(writer, name, expression_text(graph, node));
}

static void write_frame_of(xmlTextWriterPtr writer, const struct Model *model, size_t frame) {
  if (frame != BASE) write_attribute(writer, "in", model->mechanism.frames[frame].name);
}

static void write_frames(xmlTextWriterPtr writer, const struct Model *model) {
  for (size_t i = BASE + 1; i < model->mechanism.frame_count; i++) {
    const struct ReferenceFrame *frame = &model->mechanism.frames[i];
    if (frame->is_of_body) continue; /* seen as that */
    xmlTextWriterStartElement(writer, BAD_CAST "frame");
    write_attribute(writer, "name", frame->name);
    write_frame_of(writer, model, frame->parent);
    xmlTextWriterEndElement(writer);
  }
}

static bool has_tensor(const struct Body *body) {
  bool has = false;
  for (int i = 0; i < 9; i++) has |= body->tensor.row[i / 3].along[i % 3] != ZERO;
  return has;
}

static void write_tensor(xmlTextWriterPtr writer, const struct Model *model, const struct Body *body) {
  static const char *const names[3][3] = {{"Ixx", "Ixy", "Ixz"}, {"Ixy", "Iyy", "Iyz"}, {"Ixz", "Iyz", "Izz"}};
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) write_formula(writer, model->graph, names[i][j], body->tensor.row[i].along[j]);
}

static void write_body(xmlTextWriterPtr writer, const struct Model *model, const struct Body *body) {
  const char *element = body->has_angle || has_tensor(body)            ? "body"
                        : body->is_in_frame && body->mass.node == ZERO ? "point"
                                                                       : "particle";
  xmlTextWriterStartElement(writer, BAD_CAST element);
  write_attribute(writer, "name", body->name);
  write_formula(writer, model->graph, "mass", body->mass.node);
  write_formula(writer, model->graph, "inertia", body->inertia.node);
  if (body->is_in_frame) write_frame_of(writer, model, body->frame);
  write_tensor(writer, model, body);
  xmlTextWriterEndElement(writer);
}

static void write_gravity(xmlTextWriterPtr writer, const struct Model *model) {
  const Node *gravity = model->mechanism.gravity.along;
  if (gravity[0] == ZERO && gravity[1] == ZERO && gravity[2] == ZERO) return;
  xmlTextWriterStartElement(writer, BAD_CAST "gravity");
  for (int i = 0; i < 3; i++) write_formula(writer, model->graph, axes[i], gravity[i]);
  xmlTextWriterEndElement(writer);
}

bool has_scene(const struct Model *model) {
  return model->mechanism.body_count > 0 || model->mechanism.frame_count > BASE + 1;
}

void scene_write(xmlTextWriterPtr writer, const struct Model *model) {
  xmlTextWriterStartElement(writer, BAD_CAST "scene");
  write_gravity(writer, model);
  write_frames(writer, model);
  for (size_t i = 0; i < model->mechanism.body_count; i++) write_body(writer, model, &model->mechanism.bodies[i]);
  xmlTextWriterEndElement(writer);
}
