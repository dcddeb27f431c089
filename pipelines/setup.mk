# The environment: the locked versions in .venv/, and the project itself in it, editable.
#
# A stamp is written last and named after what it depends on, so that a half-made, moved or
# outdated environment is made again and a current one is left alone.
STEPS := tsas_cli/project/make
include $(STEPS)/names.mk

PYTHON ?= python3
BIN := .venv/bin
TSAS := $(BIN)/tsas
PIP := $(BIN)/python -m pip -qq --disable-pip-version-check --no-input

digest = $(shell { $(1); } 2>&1 | cksum | cut -d ' ' -f 1)
LOCKED := .venv/locked-$(call digest,$(PYTHON) -VV; pwd; cat requirements/lock.txt)
INSTALLED := .venv/installed-$(call digest,cat pyproject.toml)

# What the stages of every pipeline are told besides.
STAGE = --rrd --force

# The program that the stages run: while it is being developed, a change of it makes their outputs
# out of date too.
PROGRAM := .venv/program-$(call digest,find tsas_cli -type f ! -name '*.pyc' | sort | xargs cat; cat requirements/lock.txt)

.PHONY: setup lock
setup: $(INSTALLED)  ## make .venv/ from the locked versions, where it is not current

$(LOCKED):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo 'tsas needs Python 3.11 or newer as $(PYTHON): install it, or name it with make PYTHON=/path/to/python3.11' >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo '$(PYTHON) has no venv module: install it (Debian: apt install python3-venv)' >&2; exit 1; }
	@echo 'setting up .venv/ (one to three minutes)'
	@$(PYTHON) -m venv --clear .venv
	@$(PIP) install --require-hashes --requirement requirements/lock.txt
	@touch $@

$(INSTALLED): $(LOCKED)
	@$(PIP) install --no-deps --no-build-isolation --editable .
	@echo 'compiling the numerical kernels (a minute)'
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT \
	&& { $(TSAS) track --quiet --out "$$folder/track" & } \
	&& $(TSAS) calibrate datasets/paper-groups --quiet --out "$$folder/fit" \
	&& $(TSAS) simulate datasets/paper-groups --quiet --model "$$folder/fit/model.toml" --dynamics lugre --out "$$folder/out" \
	&& wait $$!
	@rm -f .venv/installed-* && touch $@

$(PROGRAM): $(INSTALLED)
	@rm -f .venv/program-* && touch $@

lock:  ## choose the newest versions that pyproject.toml allows, and lock them with hashes
	@folder=$$(mktemp -d) && trap 'rm -rf "$$folder"' EXIT \
	&& $(PYTHON) -m venv "$$folder" \
	&& "$$folder/bin/python" -m pip -qq --disable-pip-version-check install uv \
	&& "$$folder/bin/uv" pip compile --quiet --universal --python-version 3.11 --upgrade \
		--generate-hashes --no-emit-index-url --no-header \
		--all-extras --group dev --group docs pyproject.toml --output-file requirements/lock.txt
