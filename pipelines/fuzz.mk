# Input that breaks a reader, searched for by coverage (docs/fuzzing.md).
#
# make fuzz                                  two million executions, an hour or two on one core
# make fuzz FUZZ_RUNS=100000 FUZZ='units'    fewer, of what is named alone
FUZZ ?=
FUZZ_RUNS ?= 2000000

.PHONY: fuzz properties
fuzz: setup  ## search for input that breaks a reader, two million times; then many random tables
	@$(BIN)/python -m tests.fuzz $(FUZZ) --runs $(FUZZ_RUNS)
	@$(MAKE) properties

properties: setup  ## every property test with thousands of random examples, new ones each time
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2 --hypothesis-profile=many $$(grep -rl --include='test_*.py' '^from hypothesis import' tests)
