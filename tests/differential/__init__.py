"""
A differential test of random systems: the generator writes system.xml, SymPy derives the same system's equations from
the generator's own expressions, long doubles follow its motion, and the FMU has to agree or to refuse with a message.
"""
