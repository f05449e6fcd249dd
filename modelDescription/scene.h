/*
 * Writes <scene>: what there is to see of a system, for programs that draw it from the FMU's variables (scripts/live_page).
 * It stands in what FMI leaves to the tool: VendorAnnotations of FMI 2.0, Annotations of FMI 3.0.
 *
 *   <gravity x="" y="" z="-g"/>                           where it was given
 *   <frame name="arm" in="base"/>                         at arm.x, arm.y, arm.z, turned by arm.R11 to arm.R33
 *   <particle name="bob" mass="m" in="arm"/>              at bob.x, bob.y, bob.z, as far as there are such variables
 *   <body name="rod" mass="rho*a" in="arm" Izz=""/>       likewise, with the moments of inertia along the frame's axes
 *   <body name="crank" mass="rho*a" inertia=""/>          in the plane, turned by crank.angle; may be a frame for others
 *   <point name="tip" in="arm"/>
 *   <rod from="" to="bob" force="rod.force" factor="1"/>  whose length stays the same, from the origin without from=""; factor times
 *                                                         the force presses them apart, in N
 *   <joint of="crank" x="" y="" with="coupler" withX="" withY=""/>  a place that a body in the plane shares with another thing, in m
 *                                                         along its axes; force1, x1, y1, force2, x2, y2: its force, in N
 *   <surface of="ball" x="" y="" z="" nx="" ny="" nz=""/> a plane that a thing hits, with the normal outwards; stop="true" where a
 *                                                         coordinate has a limit there
 *
 * All but names are formulas of parameters, in m, kg, kg.m2 and m/s2; but factors, forces and surfaces, and places of joints that are no
 * sums of multiples of parameters, are numbers at their start values. Without in="..." a thing is in the base.
 */
#pragma once

#include <libxml/xmlwriter.h>

#include "model/model.h"

/* Whether there is something to see. */
bool has_scene(const struct Model *model);

void scene_write(xmlTextWriterPtr writer, const struct Model *model);
