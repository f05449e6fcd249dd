/* Elements and attributes that the model descriptions of FMI 2.0 and 3.0 share. */
#pragma once

#include <libxml/xmlwriter.h>

#include "interface/interface.h"

/* Writes UnitDefinitions with the units of the first variable_count variables; nothing if they have none. */
void write_units(xmlTextWriterPtr writer, const struct Interface *interface, size_t variable_count);

/* Writes <LogCategories>. */
void write_log_categories(xmlTextWriterPtr writer);

/* Writes DefaultExperiment. */
void write_experiment(xmlTextWriterPtr writer, const struct Model *model);

/*
 * Writes the data that pages need in addition to the variables. These are <scene>, see scene.h, and <presets>,
 * whose <preset name description> contain <at name value/> as in the system. Each is in an annotation of its own,
 * since one of FMI 2.0 has at most one element. all, each: names of the elements around all of them and around
 * each; attribute: that of each with its name.
 */
void write_annotations(xmlTextWriterPtr writer, const struct Model *model, const char *all, const char *each,
                       const char *attribute);

/* True if the description has a start value of the variable. */
bool has_start(const struct ScalarVariable *entry);

/* Writes the attributes causality, variability and initial. */
void write_classification(xmlTextWriterPtr writer, const struct InterfaceVariable *variable);

/* Returns the value of variableNamingConvention. */
const char *naming_convention(const struct Model *model);

/* Writes the attributes of the system's origin and of the generating tool. */
void write_origin(xmlTextWriterPtr writer, const struct Model *model);
