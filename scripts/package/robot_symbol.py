"""Print the name that lagc gives to a robot: letters of other alphabets become u and their code points, other characters _."""

import re
import sys


def symbol(name):
    return re.sub("[^A-Za-z0-9_]", lambda found: "_" if ord(found[0]) < 128 else f"u{ord(found[0]):04X}", name)


if __name__ == "__main__":
    print(symbol(sys.argv[1]))
