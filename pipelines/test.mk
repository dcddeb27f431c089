# Everything that must hold before a change goes in: style, types, floors of the house, behaviour.
# A module's tests stay together, since they share what takes long to make, the longest modules first
# (tests/conftest.py); three at a time on two cores, since some wait for a browser or a viewer. Byte
# code is kept even where the environment says otherwise: to make that of the tests takes half a minute.
test test-large: export PYTHONDONTWRITEBYTECODE :=

.PHONY: lint
lint: setup
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet || { echo 'ruff format would change files: run .venv/bin/ruff format' >&2; exit 1; }
	@$(BIN)/mypy --no-error-summary
	@$(BIN)/lint-imports > .venv/lint-imports.txt || { cat .venv/lint-imports.txt; exit 1; }

# The kernels' machine code and the tests' byte code are there, made beside the lint: else each of the
# three that run the tests would make all of both, at once.
KERNELS := .venv/kernels-made
$(KERNELS): $(shell find $(addprefix tsas_cli/,controllers drive effects numerics physics) -name '*.py') | setup
	@$(BIN)/python -m tests.kernels
	@touch $@

COLLECTED := .venv/tests-collected
$(COLLECTED): $(shell find tests -name '*.py' 2> /dev/null) | setup
	@$(BIN)/pytest --collect-only -qq > .venv/tests.txt || { cat .venv/tests.txt >&2; exit 1; }
	@touch $@

.PHONY: test
test: setup  ## ruff, mypy, import-linter and pytest
	@$(MAKE) -j3 lint $(KERNELS) $(COLLECTED)
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 3 --dist loadscope --no-loadscope-reorder

.PHONY: test-large
test-large: setup  ## the large versions of tests, which make test leaves out
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2 --dist load -m large
