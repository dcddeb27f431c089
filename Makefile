# Everything that is done with this project starts here; `make` alone lists it.
.DEFAULT_GOAL := help
MAKEFLAGS += --no-print-directory

# What the others build on comes first.
BASE := pipelines/setup.mk pipelines/recordings.mk
include $(BASE) $(filter-out $(BASE),$(wildcard pipelines/*.mk))

.PHONY: help
help:  ## list what make can do
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | sort | awk -F '\t' '{printf "make %-18s %s\n", $$1, $$2}'
