# Mutation testing: one change at a time in physics/, identification/, diagnosis/ or the quality
# checks, and whether a test notices it (docs/mutants.md).
#
# make mutants                               200 mutants by chance
# make mutants MUTANTS=1000 MUTANTS_SEED=3   others, and more of them
MUTANTS ?= 200
MUTANTS_SEED ?= 1

.PHONY: mutants
mutants: setup  ## judge the tests by mutants of the model, fits, diagnosis and checks
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.mutants --size $(MUTANTS) --seed $(MUTANTS_SEED)
