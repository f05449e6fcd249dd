/* What model descriptions of all versions of FMI say alike. */
#pragma once

#include <libxml/xmlwriter.h>

#include "interface/interface.h"

/* The element UnitDefinitions, where so many of the first variables have units. */
void write_units(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count);

void write_log_categories(xmlTextWriterPtr writer);

/* The element DefaultExperiment. */
void write_experiment(xmlTextWriterPtr writer, const struct Model *model);

/* Whether the description gives a start value. */
bool has_start(const struct ScalarVariable *entry);

/* The attributes causality, variability and initial. */
void write_classification(xmlTextWriterPtr writer, const struct InterfaceVariable *variable);

const char *naming_convention(const struct Model *model);

/* What is said of the system as a whole, and the tool, as attributes. */
void write_origin(xmlTextWriterPtr writer, const struct Model *model);
