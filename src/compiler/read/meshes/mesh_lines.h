/* Files of meshes that are written as text: words in lines. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "model/mesh.h"

/* Where reading stands. The text ends with a 0. */
struct MeshLines {
  const char *next;
  long line;     /* the number of the one being read, from 1 */
  char *problem; /* what is wrong; NULL for nothing */
};

/* The next word of the line, in lower case and cut to fit; false at the line's end. A backslash continues a line. */
bool next_word(struct MeshLines *lines, char *word, size_t size);

/* Goes to the next line; false at the end of the text. */
bool next_line(struct MeshLines *lines);

/* Appends a point of the line's next three numbers; false with the problem where they are none, or not finite. */
bool append_point_of_line(struct MeshLines *lines, struct Mesh *mesh);

/* The list with room for one more. */
void append_mesh_point(struct Mesh *mesh, const double point[3]);

/* False where there are as many as can be read; *problem then says so. */
bool append_triangle(struct Mesh *mesh, const size_t corners[3], char **problem);
