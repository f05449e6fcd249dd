/* The reach of shapes: balls about them, which overlap before the shapes touch. */
#pragma once

#include "read/shapes/shape_pair.h"

/*
 * Returns a mode that is positive while the balls about two shapes overlap. It is ONE for rigid contacts, and where
 * the balls would cost as much as the contact points.
 */
Node are_near(const struct ShapePair *pair);
