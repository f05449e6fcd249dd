/* Writes ModelStructure: outputs, derivatives and initial unknowns with what they truly depend on. */
#ifndef MODEL_STRUCTURE_H
#define MODEL_STRUCTURE_H

#include <libxml/xmlwriter.h>

#include "mechanics/interface.h"

void model_structure_write(xmlTextWriterPtr writer, const struct Model *model, const struct Equations *equations,
                           const struct Interface *interface);

#endif
