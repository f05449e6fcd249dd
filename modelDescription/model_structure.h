/* Writes ModelStructure: outputs, derivatives, initial unknowns and event indicators with their actual dependencies. */
#pragma once

#include <libxml/xmlwriter.h>

#include "program/program.h"

enum { FIRST_REFERENCE = 1 }; /* the first value reference in FMI 3.0, see src/runtime/fmi3/fmi3_references.h */

extern const struct StructureForm structure_of_fmi2, structure_of_fmi3;

void model_structure_write(xmlTextWriterPtr writer, const struct Program *program, const struct StructureForm *form);
