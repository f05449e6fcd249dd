"""FMUs in the importers of others: what each makes of every FMU, beside a reference."""
