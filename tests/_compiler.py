"""How tests compile: they wait for the compiler, not for what it compiles."""

QUICK = "--xla_cpu_use_fusion_emitters=false"
"""XLA's older code generator takes a third less time, for programs that run slower."""
