/* Lines and words of mesh files in text form. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "model/mesh.h"

/* The reading position in a text with a terminating zero. */
struct MeshLines {
  const char *next;
  long line;     /* number of the current line, from 1 */
  char *problem; /* the error; NULL for none */
};

/*
 * Reads the next word of the line in lower case, truncated to the size. Returns false at the end of the line. A
 * backslash continues a line.
 */
bool next_word(struct MeshLines *lines, char *word, size_t size);

/* Advances to the next line. Returns false at the end of the text. */
bool next_line(struct MeshLines *lines);

/* Appends a point with the line's next three numbers. Returns false with the problem set for invalid ones. */
bool append_point_of_line(struct MeshLines *lines, struct Mesh *mesh);

/* Appends a point to the mesh. */
void append_mesh_point(struct Mesh *mesh, const double point[3]);

/* Appends a triangle of indices of points. Returns false with *problem set if the mesh has too many. */
bool append_triangle(struct Mesh *mesh, const size_t corners[3], char **problem);
