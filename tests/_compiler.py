"""How tests compile: they wait for the compiler, not for what it compiles."""

QUICK = " ".join(
    (
        "--xla_cpu_use_fusion_emitters=false",
        "--xla_backend_optimization_level=0",
        "--xla_cpu_parallel_codegen_split_count=1",
    )
)
"""XLA's older code generator and none of LLVM's optimisation take half the time, for programs that run slower. Whole, a
program takes a sixth less than in parts that are compiled beside each other, and there is a worker for each core."""
