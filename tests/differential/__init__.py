"""
Differential test with random systems: the generator writes system.xml, SymPy derives the equations from the generator's own expressions,
long doubles integrate them, and the FMU has to agree or to fail with a message.
"""
