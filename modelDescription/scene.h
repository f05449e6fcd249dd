/*
 * Writes <scene>: the geometry of a system, for programs that draw it from the FMU's variables (scripts/library/live_page). It
 * is in VendorAnnotations of FMI 2.0 and in Annotations of FMI 3.0.
 *
 *   <gravity x="" y="" z="-g"/>                           if it was given
 *   <frame name="arm" in="base"/>                         at arm.x, arm.y, arm.z, rotated by arm.R11 to arm.R33
 *   <particle name="bob" mass="m" in="arm"/>              at bob.x, bob.y, bob.z, if there are such variables
 *   <body name="rod" mass="rho*a" in="arm" Izz=""/>       also with moments of inertia along the frame's axes
 *   <body name="crank" mass="rho*a" inertia=""/>          planar, rotated by crank.angle; may be a frame of others
 *   <point name="tip" in="arm"/>
 *   <line kind="rod" from="" to="bob" radius="r"/>        drawn, without mechanics; from, to: "" is the origin; instead
 *                                                         x1, y1, z1 and x2, y2, z2, formulas of variables of the FMU;
 *                                                         guessed="true": of a <spring>, without any <line>
 *   <rod from="" to="bob" force="rod.force" factor="1"/>  of constant length; from="" is the origin; factor times force
 *                                                         is its compressive force, in N
 *   <joint of="crank" x="" y="" with="coupler" withX="" withY=""/>  a point that a planar body shares with another
 *                                                         object, in m along its axes; force1, x1, y1, force2, x2,
 *                                                         y2: its force, in N
 *   <surface of="ball" x="" y="" z="" nx="" ny="" nz=""/> a plane that an object hits, with the outward normal;
 *                                                         stop="true" at the limit of a coordinate
 *
 * The FMU's page has a start scene, with numbers at the start values in place of formulas. Its objects have x, y, z and
 * rotation or angle. It has rods, joints and surfaces if the author draws no lines, and also
 *
 *   <scene right="1 0 0" up="0 1 0">                      directions of the picture
 *   <particle label="m1"/> <line label="l1"/>             the mass, and the parameter that is the length
 *   <coordinate name="x" start="" from="" to="" along=""/>  along a line, from 0 to the start value
 *   <coordinate name="phi" start="" from="" to="" axis=""/>  of a point that turns about another one and an axis
 *   <input name="u"/> <output name="y"/>                  of a system without objects
 *
 * All values except names are formulas of parameters, in m, kg, kg.m2 and m/s2. Exceptions, as numbers at the start
 * values: factors, forces, surfaces, and coordinates of joints that are not linear in the parameters. Without in="..."
 * an object is in the base.
 */
#pragma once

#include <libxml/xmlwriter.h>

#include "scene/start_scene.h"

/* True if the system has bodies, frames, shapes or lines. */
bool has_scene(const struct Model *model);

void scene_write(xmlTextWriterPtr writer, const struct Model *model);

/* Writes the scene for the page. */
void start_scene_write(xmlTextWriterPtr writer, const struct StartScene *scene);
