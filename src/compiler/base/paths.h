/* Paths of files that name each other. */
#pragma once

/* Returns the canonical absolute path of a file; NULL with errno set if there is no such file. */
char *canonical_path(const char *path);

/* Returns the name of a file without its folder, as a part of path. */
const char *file_name(const char *path);

/* Returns the path of a file that another file, present, names relative to itself. */
char *path_beside_file(const char *present, const char *named);
