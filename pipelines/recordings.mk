# From a dataset to a report: check, calibrate, simulate, diagnose, report. The steps are those of
# the project that `tsas init` writes; each runs again only when what it reads has changed.
#
# make run                                   on the shipped recordings
# make pipeline DATASET=folder OUT=folder    on your own
SETTINGS = --no-print-directory --eval '$(PROGRAM):' PROGRAM='$(PROGRAM)' TSAS=$(call quoted,$(TSAS)) STAGE=$(call quoted,$(STAGE))
DIAGNOSED = $(MAKE) -f $(STEPS)/names.mk -f $(STEPS)/chain.mk $(SETTINGS)
INGESTED = $(DIAGNOSED) -f $(STEPS)/ingest.mk

.PHONY: run pipeline
run: $(PROGRAM)  ## check, calibrate, simulate, diagnose and report on the shipped recordings
	+@$(DIAGNOSED) DATASET=datasets/paper-groups OUT=reports/run

pipeline: $(PROGRAM)  ## the same on your own: make pipeline DATASET=folder OUT=folder
	+@test -f '$(call place,DATASET)/dataset.toml' || { echo 'no dataset.toml in $(DATASET): make one from your files with tsas ingest' >&2; exit 2; }
	+@$(DIAGNOSED) DATASET='$(DATASET)' OUT='$(call place,OUT)'
