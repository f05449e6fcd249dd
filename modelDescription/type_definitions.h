/* TypeDefinitions: physical quantities of units, such as SI.Angle for rad, named as in Modelica. */
#pragma once

#include <libxml/xmlwriter.h>

#include "interface/interface.h"

/* Returns the type of a variable; NULL for non-real variables and units without a unique quantity. */
const char *declared_type(const struct InterfaceVariable *variable);

/*
 * Writes TypeDefinitions with the types of the first variable_count variables. real: the version's element for real
 * types, "Real" in SimpleType (FMI 2.0, section 2.2.3) or "Float64Type" (FMI 3.0, section 2.4.5).
 */
void write_types(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count, const char *real);
