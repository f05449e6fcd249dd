"""python -m lagrange_fmu is the command lagrange-fmu."""

from .command import main

main()
