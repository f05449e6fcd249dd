/*
 * Writes <scene>: what there is to see of a system, for programs that draw it from the FMU's variables (scripts/animation,
 * src/icon). FMI 2.0.4 leaves VendorAnnotations of modelDescription.xml to the tool (section 2.2.1).
 *
 *   <particle name="bob" mass="m"/>                      at bob.x, bob.y, bob.z, as far as there are such variables
 *   <body name="rod" mass="rho*a" inertia="..."/>        in the plane, turned by rod.angle
 *
 * Masses and inertias are formulas of parameters, in kg and kg.m2.
 */
#ifndef SCENE_H
#define SCENE_H

#include <libxml/xmlwriter.h>

#include "mechanics/model.h"

/* Nothing for a model without bodies. */
void scene_write(xmlTextWriterPtr writer, const struct Model *model);

#endif
