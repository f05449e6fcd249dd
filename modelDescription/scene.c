#include "scene.h"

#include <stdlib.h>

#include "algebra/formula.h"
#include "xml_output.h"

static void write_formula(xmlTextWriterPtr writer, const struct Graph *graph, const char *name, Node node) {
  char *text = expression_text(graph, node);
  write_attribute(writer, name, text);
  free(text);
}

static void write_body(xmlTextWriterPtr writer, const struct Model *model, const struct Body *body) {
  xmlTextWriterStartElement(writer, BAD_CAST(body->has_angle ? "body" : "particle"));
  write_attribute(writer, "name", body->name);
  write_formula(writer, model->graph, "mass", body->mass.node);
  if (body->has_angle) write_formula(writer, model->graph, "inertia", body->inertia.node);
  xmlTextWriterEndElement(writer);
}

void scene_write(xmlTextWriterPtr writer, const struct Model *model) {
  if (model->body_count == 0) return;
  xmlTextWriterStartElement(writer, BAD_CAST "VendorAnnotations");
  xmlTextWriterStartElement(writer, BAD_CAST "Tool");
  write_attribute(writer, "name", "lagrange-fmu");
  xmlTextWriterStartElement(writer, BAD_CAST "scene");
  for (size_t i = 0; i < model->body_count; i++) write_body(writer, model, &model->bodies[i]);
  for (int element = 0; element < 3; element++) xmlTextWriterEndElement(writer);
}
