"""
Differential test with random systems. The generator writes system.xml, SymPy derives the equations from the generator's own expressions, and long
doubles integrate them. The FMU has to agree or to fail with a message.
"""
