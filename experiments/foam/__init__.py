"""The experiment on foam that outlives breaking."""
