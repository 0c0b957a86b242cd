"""How tests compile: they wait for the compiler, not for what it compiles."""

QUICK = "--xla_cpu_use_fusion_emitters=false --xla_backend_optimization_level=0"
"""XLA's older code generator and none of LLVM's optimisation take half the time, for programs that run slower."""
