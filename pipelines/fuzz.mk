# Input that breaks a reader, searched for by coverage (docs/fuzzing.md).
#
# make fuzz                                  two million executions, an hour or two on one core
# make fuzz FUZZ_RUNS=100000 FUZZ='units'    fewer, of what is named alone
# make fuzz-short                            a minute of it on one core
FUZZ ?=
FUZZ_RUNS ?= 2000000
FUZZ_SECONDS ?= 5
FUZZ_SHORT := delimited guess ingest json_table model stage_files units
PROPERTIES = $(shell grep -rl --include='test_*.py' '^from hypothesis import' tests)

.PHONY: fuzz fuzz-short properties
fuzz: setup  ## search for input that breaks a reader, two million times; then many random tables
	@$(BIN)/python -m tests.fuzz $(FUZZ) --runs $(FUZZ_RUNS)
	@$(MAKE) properties

fuzz-short: setup  ## a minute of that search
	@$(BIN)/python -m tests.fuzz $(FUZZ_SHORT) --seconds $(FUZZ_SECONDS) --out reports/fuzz-short

properties: setup  ## every property test with thousands of random examples, new ones each time
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2 --hypothesis-profile=many $(PROPERTIES)
