/*
 * Writes <scene>: what there is to see of a system, for programs that draw it from the FMU's variables (scripts/animation).
 * It stands in what FMI leaves to the tool: VendorAnnotations of FMI 2.0, Annotations of FMI 3.0.
 *
 *   <gravity x="" y="" z="-g"/>                           where it was given
 *   <frame name="arm" in="base"/>                         at arm.x, arm.y, arm.z, turned by arm.R11 to arm.R33
 *   <particle name="bob" mass="m" in="arm"/>              at bob.x, bob.y, bob.z, as far as there are such variables
 *   <body name="rod" mass="rho*a" in="arm" Izz=""/>       likewise, with the moments of inertia along the frame's axes
 *   <body name="crank" mass="rho*a" inertia=""/>          in the plane, turned by crank.angle; may be a frame for others
 *   <point name="tip" in="arm"/>
 *
 * All but names are formulas of parameters, in kg, kg.m2 and m/s2. Without in="..." a thing is in the base.
 */
#pragma once

#include <libxml/xmlwriter.h>

#include "model/model.h"

/* Whether there is something to see. */
bool has_scene(const struct Model *model);

void scene_write(xmlTextWriterPtr writer, const struct Model *model);
