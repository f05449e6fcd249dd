/* Names of a robot's file as names in a system. */
#pragma once

/*
 * Returns the name as an identifier of the language: letters, digits and _, with no digit first. A letter of another
 * alphabet becomes u and its code point.
 */
char *robot_symbol(const char *name);

/* Returns the symbol of a link or joint; names that a system already has get a _ at the end. */
char *robot_part_symbol(const char *name);
