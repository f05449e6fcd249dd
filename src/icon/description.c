#include "description.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/xpath.h>

/* The text of the first node that the path finds, to be freed with xmlFree(); NULL where there is none. */
static xmlChar *find(xmlXPathContextPtr context, const char *path) {
  xmlXPathObjectPtr found = xmlXPathEvalExpression((const xmlChar *)path, context);
  xmlChar *text = NULL;
  if (found != NULL && found->nodesetval != NULL && found->nodesetval->nodeNr > 0)
    text = xmlNodeGetContent(found->nodesetval->nodeTab[0]);
  xmlXPathFreeObject(found);
  return text;
}

static bool find_number(xmlXPathContextPtr context, const char *path, double *number) {
  xmlChar *text = find(context, path);
  if (text == NULL) return false;
  *number = strtod((const char *)text, NULL);
  xmlFree(text);
  return true;
}

static bool find_reference(xmlXPathContextPtr context, const char *path, fmi2ValueReference *reference) {
  double number;
  if (!find_number(context, path, &number)) return false;
  *reference = (fmi2ValueReference)number;
  return true;
}

#define VARIABLES "/fmiModelDescription/ModelVariables/ScalarVariable"

/* derivative="i" of a ScalarVariable names its state; the first is of a coordinate, and its value is a velocity. */
static bool find_shown(xmlXPathContextPtr context, struct Description *description) {
  char coordinate[sizeof VARIABLES + 60];
  double place = 0.0;
  find_number(context, "(" VARIABLES "/Real/@derivative)[1]", &place);
  snprintf(coordinate, sizeof coordinate, VARIABLES "[%.0f]/@valueReference", place);
  description->has_states =
      find_reference(context, coordinate, &description->shown[0]) &&
      find_reference(context, "(" VARIABLES "[Real/@derivative])[1]/@valueReference", &description->shown[1]) &&
      find_reference(context, VARIABLES "[@name='solverSteps']/@valueReference", &description->solver_steps);
  return description->has_states ||
         (find_reference(context, "(" VARIABLES "[@causality='input'])[1]/@valueReference", &description->shown[0]) &&
          find_reference(context, "(" VARIABLES "[@causality='output'])[1]/@valueReference", &description->shown[1]));
}

static double count_states(xmlXPathContextPtr context) {
  xmlXPathObjectPtr found = xmlXPathEvalExpression((const xmlChar *)"count(" VARIABLES "/Real/@derivative)", context);
  double count = found != NULL ? found->floatval : 0.0;
  xmlXPathFreeObject(found);
  return count;
}

bool description_read(const char *path, struct Description *description) {
  *description = (struct Description){.stop_time = 10.0};
  xmlDocPtr document = xmlReadFile(path, NULL, XML_PARSE_NONET);
  xmlXPathContextPtr context = document != NULL ? xmlXPathNewContext(document) : NULL;
  bool found = false;
  if (context != NULL) {
    xmlChar *guid = find(context, "/fmiModelDescription/@guid");
    if (guid != NULL) description->guid = strdup((const char *)guid);
    xmlFree(guid);
    find_number(context, "/fmiModelDescription/DefaultExperiment/@stopTime", &description->stop_time);
    description->states = count_states(context);
    found = find_shown(context, description) && description->guid != NULL;
  }
  if (!found)
    fprintf(stderr, "icon: %s: expected a modelDescription.xml with states, or with inputs and outputs\n", path);
  xmlXPathFreeContext(context);
  xmlFreeDoc(document);
  return found;
}

void description_free(struct Description *description) {
  free(description->guid);
  xmlCleanupParser();
}
