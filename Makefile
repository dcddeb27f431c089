# Everything that is done with this project starts here; `make` alone lists it.
.DEFAULT_GOAL := help
.SUFFIXES:
MAKEFLAGS += --no-print-directory

include pipelines/setup.mk $(filter-out pipelines/setup.mk,$(wildcard pipelines/*.mk))

.PHONY: help
help:  ## list what make can do
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | sort | awk -F '\t' '{printf "make %-18s %s\n", $$1, $$2}'
