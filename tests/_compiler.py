"""How tests compile: they wait for the compiler, not for what it compiles."""

QUICK = "--xla_cpu_use_fusion_emitters=false --xla_backend_optimization_level=0"
"""XLA's older code generator takes a third less time, and LLVM half of it if it does not optimise: for programs that
run slower. Users run neither; what rounding decides may then fall out otherwise, which is as good a test."""
