# Everything that must hold before a change goes in: style, types, floors of the house, behaviour.
.PHONY: test
test: setup  ## ruff, mypy, import-linter and pytest
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet || { echo 'ruff format would change files: run .venv/bin/ruff format' >&2; exit 1; }
	@$(BIN)/mypy --no-error-summary
	@$(BIN)/lint-imports > .venv/lint-imports.txt || { cat .venv/lint-imports.txt; exit 1; }
	@TSAS_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2
