#include "read/robots/robot.h"
