# Everything that must hold before a change goes in: style, types, floors of the house, behaviour.
# A module's tests stay together, since they share what takes long to make, the longest modules first
# (tests/conftest.py); three at a time on two cores, since some wait for a browser or a viewer. Byte
# code is kept even where the environment says otherwise: to make that of the tests takes each of the
# three half a minute.
test test-large: export PYTHONDONTWRITEBYTECODE :=

.PHONY: lint
lint: setup
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet || { echo 'ruff format would change files: run .venv/bin/ruff format' >&2; exit 1; }
	@$(BIN)/mypy --no-error-summary
	@$(BIN)/lint-imports > .venv/lint-imports.txt || { cat .venv/lint-imports.txt; exit 1; }

# The kernels' machine code is there, made from these sources by two processes: else each of the three
# that run the tests would make all of it, at once.
KERNELS := .venv/kernels-made
$(KERNELS): $(shell find $(addprefix tsas_cli/,controllers drive effects numerics physics) -name '*.py') | lint
	@printf 'calibrate\ntrack\n' | xargs -P 2 -n 1 $(BIN)/python -m tests.kernels
	@touch $@

.PHONY: test
test: lint $(KERNELS)  ## ruff, mypy, import-linter and pytest
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 3 --dist loadscope --no-loadscope-reorder

.PHONY: test-large
test-large: setup  ## the large versions of tests, which make test leaves out
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2 --dist load -m large
