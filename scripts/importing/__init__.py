"""Run all FMUs in the importers of other tools, and compare the results with a reference."""
