#include "read/robots/description/robot.h"
