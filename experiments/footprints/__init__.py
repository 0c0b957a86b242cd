"""The experiment on closures in footprints."""
