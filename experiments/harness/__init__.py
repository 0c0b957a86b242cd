"""A run: configs loaded, results written, finished runs found again."""
