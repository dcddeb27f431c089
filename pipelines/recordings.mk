# From a dataset to a report: check, calibrate, simulate, diagnose, report. The steps are those of
# the project that `tsas init` writes; each runs again only when what it reads has changed.
#
# make run                                   on the shipped recordings
# make pipeline DATASET=folder OUT=folder    on your own
STEPS := tsas_cli/project/make
SETTINGS = --no-print-directory --eval '$(PROGRAM):' PROGRAM='$(PROGRAM)' TSAS='$(TSAS)' STAGE='$(STAGE)'
DIAGNOSED = $(MAKE) -f $(STEPS)/chain.mk $(SETTINGS)
INGESTED = $(MAKE) -f $(STEPS)/ingest.mk -f $(STEPS)/chain.mk $(SETTINGS)

.PHONY: run pipeline
run: $(PROGRAM)  ## check, calibrate, simulate, diagnose and report on the shipped recordings
	+@$(DIAGNOSED) DATASET=datasets/paper-groups OUT=reports/run

pipeline: $(PROGRAM)  ## the same on your own: make pipeline DATASET=folder OUT=folder
	+@test -n '$(DATASET)' -a -n '$(OUT)' || { echo 'say on what and where to: make pipeline DATASET=folder OUT=folder' >&2; exit 2; }
	+@test -f '$(DATASET)/dataset.toml' || { echo 'no dataset.toml in $(DATASET): make one from your files with tsas ingest' >&2; exit 2; }
	+@$(DIAGNOSED) DATASET='$(DATASET)' OUT='$(OUT)'
