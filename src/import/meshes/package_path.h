/* Paths of meshes in robot files. */
#pragma once

/*
 * Returns the path of a file that a robot file names, relative to the robot file; NULL if it does not exist. named: a
 * path, file:///PATH, or package://NAME/PATH. The last is NAME/PATH or PATH in the robot's folder or the nearest folder
 * above it.
 */
char *path_in_package(const char *robot, const char *named);
