#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/xpath.h>

#define SCENE "/fmiModelDescription/VendorAnnotations/Tool[@name='lagrange-fmu']/scene"

static const char *const kinds[] = {[FRAME] = "frame", [BODY] = "body", [PARTICLE] = "particle", [POINT] = "point"};
static const char *const position[] = {"x", "y", "z"};
static const char *const turn[] = {"R11", "R12", "R13", "R21", "R22", "R23", "R31", "R32", "R33"};

/* Of the scalar variables; those of a system with frames are few. */
static bool find_references(const xmlNodeSet *variables, const char *name, const char *const *components, int count,
                            fmi2ValueReference *references) {
  int found = 0;
  for (int component = 0; component < count; component++)
    for (int i = 0; i < variables->nodeNr; i++) {
      xmlChar *full = xmlGetProp(variables->nodeTab[i], BAD_CAST "name");
      size_t length = strlen(name);
      bool same = full != NULL && strncmp((char *)full, name, length) == 0 && full[length] == '.' &&
                  strcmp((char *)full + length + 1, components[component]) == 0;
      xmlFree(full);
      if (!same) continue;
      xmlChar *reference = xmlGetProp(variables->nodeTab[i], BAD_CAST "valueReference");
      references[component] = (fmi2ValueReference)strtoul((char *)reference, NULL, 10);
      xmlFree(reference);
      found++;
      break;
    }
  return found == count;
}

/* The place of a frame among the elements. */
static int find_frame(const xmlNodeSet *elements, const xmlChar *name) {
  for (int i = 0; i < elements->nodeNr && name != NULL; i++) {
    xmlChar *other = xmlGetProp(elements->nodeTab[i], BAD_CAST "name");
    bool same = xmlStrEqual(other, name) && xmlStrEqual(elements->nodeTab[i]->name, BAD_CAST "frame");
    xmlFree(other);
    if (same) return i;
  }
  return IN_BASE;
}

/* False for what cannot be drawn in space, such as a body in the plane. */
static bool read_thing(const xmlNodeSet *elements, const xmlNodeSet *variables, int place, struct Thing *thing) {
  xmlNodePtr element = elements->nodeTab[place];
  xmlChar *name = xmlGetProp(element, BAD_CAST "name"), *frame = xmlGetProp(element, BAD_CAST "in");
  for (int kind = FRAME; kind <= POINT; kind++)
    if (xmlStrEqual(element->name, BAD_CAST kinds[kind])) thing->kind = (enum ThingKind)kind;
  thing->frame = find_frame(elements, frame);
  bool found = name != NULL && find_references(variables, (char *)name, position, 3, thing->position) &&
               (thing->kind != FRAME || find_references(variables, (char *)name, turn, 9, thing->turn));
  xmlFree(name);
  xmlFree(frame);
  return found;
}

/* Gravity is a formula; one that does not begin with a minus is taken for upwards. */
static void read_gravity(xmlXPathContextPtr context, struct Scene *scene) {
  *scene = (struct Scene){.up = 2, .upwards = 1.0};
  for (int axis = 0; axis < 3; axis++) {
    char path[sizeof SCENE + 20];
    snprintf(path, sizeof path, "string(" SCENE "/gravity/@%s)", position[axis]);
    xmlXPathObjectPtr found = xmlXPathEvalExpression(BAD_CAST path, context);
    if (found != NULL && found->stringval != NULL && found->stringval[0] != '\0') {
      scene->up = axis;
      scene->upwards = found->stringval[0] == '-' ? 1.0 : -1.0;
    }
    xmlXPathFreeObject(found);
  }
}

bool scene_read(const char *path, struct Scene *scene) {
  xmlDocPtr document = xmlReadFile(path, NULL, XML_PARSE_NONET);
  xmlXPathContextPtr context = document != NULL ? xmlXPathNewContext(document) : NULL;
  if (context == NULL) return false;
  read_gravity(context, scene);
  /* Of nothing where there is no frame. */
  xmlXPathObjectPtr elements = xmlXPathEvalExpression(
      BAD_CAST SCENE "[frame]/*[self::frame or self::body or self::particle or self::point]", context);
  xmlXPathObjectPtr variables =
      xmlXPathEvalExpression(BAD_CAST "/fmiModelDescription/ModelVariables/ScalarVariable", context);
  int count = elements != NULL && elements->nodesetval != NULL ? elements->nodesetval->nodeNr : 0;
  if (count > 0) scene->things = calloc((size_t)count, sizeof *scene->things);
  bool right = count == 0 || (scene->things != NULL && variables != NULL && variables->nodesetval != NULL);
  for (int i = 0; i < count && right; i++) {
    struct Thing *thing = &scene->things[scene->count];
    /* The places of frames, which come first, are those among the elements. */
    if (read_thing(elements->nodesetval, variables->nodesetval, i, thing)) scene->count++;
  }
  xmlXPathFreeObject(elements);
  xmlXPathFreeObject(variables);
  xmlXPathFreeContext(context);
  xmlFreeDoc(document);
  return right;
}

void scene_free(struct Scene *scene) {
  free(scene->things);
}
