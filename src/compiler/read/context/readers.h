/* Readers of elements that have no other functions, by the passes of elements.c. */
#pragma once

#include "read/context/attributes.h"

/* Reads an element. */
typedef void ElementReader(struct Reader *reader, xmlNodePtr node);

/* <bushing>: adds springs and dampers along and about the axes of `from` to the potential and the dissipation. */
ElementReader read_bushing;

/* Declares the constraint of a <constraint>. Its name has no value of its own; that of its force has one. */
ElementReader declare_constraint;

/* Reads the expression of a <constraint> and checks it. */
ElementReader read_constraint;

/* Defines the function of a <function>. Its expression is parsed at each call. */
ElementReader declare_function;

/* Declares a <table>: a function of one or two arguments, interpolated between points. */
ElementReader read_table;

/*
 * Reads a <preset>, named start values that pages and programs offer, after all variables are declared. Reports what
 * cannot be set, and values out of range.
 */
ElementReader read_preset;

/*
 * Reads a <task> with its goals, in the pass DRAWING, after all presets: an exercise on the live page. Reports goals
 * without limits and unknown presets.
 */
ElementReader read_task;
