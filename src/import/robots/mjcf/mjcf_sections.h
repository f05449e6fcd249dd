/* The readers of the sections of an MJCF file, which mjcf.c calls in the order of their dependencies. */
#pragma once

#include "robots/mjcf/values/mjcf_values.h"

/* Reads an element of a section. */
typedef void MjcfReader(struct Mjcf *mjcf, xmlNodePtr node);

/* <tendon>: fixed tendons, linear combinations of joint positions, and spatial ones through sites; after all joints. */
MjcfReader mjcf_read_tendon;

/* Returns the tendon of this name; NULL after reporting that there is none. */
const struct Tendon *mjcf_tendon(struct Mjcf *mjcf, xmlNodePtr node, const char *name);

/* <flag>: features that it disables. Most of them are removed by the second function, after all sections. */
MjcfReader mjcf_read_flag;
void mjcf_remove_disabled(struct Mjcf *mjcf);

/* Lets the control of an actuator do nothing. */
void mjcf_switch_off(struct Actuator *actuator);

/* <actuator>: forces on joints and tendons that depend on a control; after all joints and tendons. */
MjcfReader mjcf_read_actuator;

/*
 * <equality>: joints and tendons that follow others, and kinematic loops; after all bodies, sites and joints. Soft in
 * MuJoCo, exact constraints here.
 */
MjcfReader mjcf_read_equality;

/*
 * Sets the inertia and the shapes of a link, in its frame, from <inertial> and <geom>. Geoms of the world have no mass.
 */
void mjcf_read_body(struct Mjcf *mjcf, xmlNodePtr node, struct RobotLink *link);

/* Notes a joint with the attribute springdamper, of positive numbers: time constant, damping ratio. Reports others. */
void mjcf_note_spring(struct Mjcf *mjcf, xmlNodePtr node, struct RobotJoint *joint);

/*
 * Sets stiffness and damping of the noted joints, and replaces the damping ratios of actuators by their dampings; after
 * all bodies and actuators.
 */
void mjcf_set_springs(struct Mjcf *mjcf);

/*
 * Sets the start values of joints and actuators to those of the <key> that the options name; called after all of them
 * are read. Reports a missing key.
 */
void mjcf_read_keyframe(struct Mjcf *mjcf);

/* Warns of attributes that are not read and may change the motion. */
void mjcf_check_attributes(struct Mjcf *mjcf);
