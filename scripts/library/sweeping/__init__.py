"""Many runs of an FMU, as rows of a Parquet file."""
