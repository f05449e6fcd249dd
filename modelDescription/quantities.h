/* TypeDefinitions: what variables of a unit measure, such as SI.Angle of rad, by the names that Modelica has for it. */
#pragma once

#include <libxml/xmlwriter.h>

#include "interface/interface.h"

/* The type of a variable; NULL for one that is no real number, and for units that several quantities have, or none. */
const char *declared_type(const struct InterfaceVariable *variable);

/*
 * The element TypeDefinitions, where so many of the first variables have such types. real: what the version of FMI calls the type of
 * real numbers: "Real", an element in SimpleType (FMI 2.0, 2.2.3), or "Float64Type" (FMI 3.0, 2.4.5).
 */
void write_types(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count, const char *real);
